"""Progress of a run or a study: one status line on a terminal, a line every ten seconds in a log with -v.

Written here and not by a library: the least one that estimates the remaining time adds a tenth to the start.
"""

import sys
import time
from collections.abc import Callable
from threading import Event, Thread
from typing import Any

from ...errors import Fault, visible
from .screen import notify, terminal_width

REDRAWN_AFTER = 0.1  # s
LOGGED_AFTER = 10.0  # s
SAID_AFTER = 2.0  # s, of compiling, where nothing is drawn
TICK = 1.0  # s, between two times of what is waited for on a terminal


class Progress:
    """Shows how many of `unit` are done, after `title`; as a context, ends its line before others print."""

    said = False  # whether this process has said what takes long

    def __init__(self, title: str, unit: str, quiet: bool, verbose: bool, stream: Any = None):
        self.title, self.unit, self.quiet = title, unit, quiet
        self.stream = stream or sys.stderr
        self.drawn = not quiet and self.stream.isatty()
        self.logged = not quiet and verbose and not self.drawn
        self.total = self.done = self.first = 0
        self.began = self.shown = time.monotonic()
        self.standing = False
        self.waiting: _Waiting | None = None

    def notice(self, fault: Fault) -> None:
        """Print a warning or a note, which stays; the status line continues below it."""
        doing = self.waiting.sentence if self.waiting else None
        self.clear()
        if not self.quiet:
            notify(f"flexmb: {fault.severity}: {fault.sentence}")
        if doing:
            self._wait(doing)

    def status(self, doing: str) -> None:
        """Show what happens before the first row, such as compiling, with the time so far, until it ends."""
        if self.drawn:
            self._draw(f"{self.title}: {doing}")
        elif self.logged:
            notify(f"{self.title}: {doing}")
        if self.drawn or self.logged:
            self._wait(f"{self.title}: {doing}")
        elif not self.quiet and not Progress.said:
            self._end_waiting()
            self.waiting = _Waiting(f"{self.title}: {doing}", self._say_once, SAID_AFTER)

    def _say_once(self, sentence: str) -> None:
        """Say what takes long where no line can be drawn; a process says it once."""
        if not Progress.said:
            Progress.said = True
            notify(sentence)

    def begin(self, total: int) -> None:
        """Begin to count up to `total`; what is waited for stays: kernels are compiled for the first row."""
        self.total, self.done, self.first = total, 0, 0
        self.began = self.shown = time.monotonic()
        if self.waiting or total <= 1:
            return
        if self.drawn:
            self._draw(self.sentence(self.began))
        elif self.logged:
            self._wait(self.sentence(self.began))

    def advance(self, count: int) -> None:
        """Count what was done, and show it when it is time."""
        self._end_waiting()
        now = time.monotonic()
        if not self.done:
            # Kernels are compiled before the first rows, so their time does not count for the rate.
            self.first, self.began = count, now
        self.done += count
        if self.drawn and self.total > 1 and now - self.shown >= REDRAWN_AFTER:
            self.shown = now
            self._draw(self.sentence(now))
        elif self.logged and now - self.shown >= LOGGED_AFTER:
            self.shown = now
            notify(self.sentence(now))

    def sentence(self, now: float) -> str:
        """Return the count, the rate and the remaining time at `now` of the monotonic clock."""
        text = f"{self.title}: {self.done} of {self.total} {self.unit}"
        elapsed, timed = now - self.began, self.done - self.first
        if not timed or elapsed <= 0:
            return text
        rate = timed / elapsed
        left = (self.total - self.done) / rate
        return f"{text}, {100 * self.done // self.total} %, {rate:.3g} {self.unit}/s, {_duration(left)} left"

    def clear(self) -> None:
        """Take the status line away."""
        self._end_waiting()
        if self.standing:
            self.stream.write("\r\x1b[K")
            self.stream.flush()
            self.standing = False

    def _wait(self, sentence: str) -> None:
        self._end_waiting()
        show, every = (self._draw, TICK) if self.drawn else (notify, LOGGED_AFTER)
        self.waiting = _Waiting(sentence, show, every)

    def _end_waiting(self) -> None:
        if self.waiting:
            self.waiting.end()
            self.waiting = None

    def _draw(self, text: str) -> None:

        # The last column stays free: some terminals wrap as soon as it is filled.
        line = _fitted(visible(text), len(visible(self.title)), terminal_width(self.stream) - 1)
        self.stream.write(f"\r\x1b[K{line}")
        self.stream.flush()
        self.standing = True

    def __enter__(self) -> "Progress":
        return self

    def __exit__(self, *failure: Any) -> None:
        self.clear()


class _Waiting:
    """Repeats a sentence with the time since, from a thread: the one that compiles reports nothing."""

    def __init__(self, sentence: str, show: Callable[[str], None], every: float):
        self.sentence, self.show, self.every, self.ended = sentence, show, every, Event()
        self.thread = Thread(target=self._repeat, daemon=True)
        self.thread.start()

    def _repeat(self) -> None:
        began = time.monotonic()
        while not self.ended.wait(self.every):
            self.show(f"{self.sentence}: {_duration(time.monotonic() - began)} so far")

    def end(self) -> None:
        """Repeat it no more."""
        self.ended.set()
        self.thread.join()


def _fitted(text: str, title: int, width: int) -> str:
    """Return a line of at most `width` characters: the first ones of its title, a path, may be left out."""
    surplus = len(text) - width
    if surplus > 0 and surplus + 1 < title:
        return f"…{text[surplus + 1 :]}"
    return text[:width]


def _duration(seconds: float) -> str:
    whole = round(seconds)
    hours, minutes = whole // 3600, whole // 60 % 60
    return f"{hours}:{minutes:02}:{whole % 60:02}" if hours else f"{minutes}:{whole % 60:02}"
