"""Kills and signals: at every deed to a file, at random moments, of processes and of all their workers."""

import os
import re
import signal
import time
from dataclasses import dataclass, field

from . import trip as trips
from .child import Hit, run_forked, run_process
from .judge import KILLED, faults_of_end, faults_of_files, faults_of_finish
from .stage import ANSWERS, VALUES, Command, study, undisturbed
from .trip import Trip

LATEST = 1.1  # of the undisturbed time, for random moments
LONGEST_END = 30.0  # s, in which a worker that is still importing learns that its parent is gone


@dataclass
class Verdict:
    """What became of one injected fault; `resumed`: stops from which a command went on to the same bytes."""

    what: str
    faults: list[str] = field(default_factory=list)
    resumed: int = 0
    skipped: str = ""


def kill_at_deeds(stage, chance, number, folder) -> Verdict:
    """SIGKILL just before the n-th deed: every command, every moment in its turn."""
    command = stage.spread(stage.writers, number)
    at = 1 + number // len(stage.writers) % command.deeds
    return _hit_and_finish(command, folder, Hit(trip=Trip(str(folder), at)), chance.random() < 0.5)


def torn_writes(stage, chance, number, folder) -> Verdict:
    """SIGKILL in the midst of the n-th deed, where that is a write: half of it is on the disk."""
    command = stage.spread(stage.writers, number)
    trip = Trip(str(folder), chance.randint(1, command.deeds), trips.TORN)
    return _hit_and_finish(command, folder, Hit(trip=trip), chance.random() < 0.5)


def kill_at_any_time(stage, chance, number, folder) -> Verdict:
    """SIGKILL at a random moment."""
    command = stage.spread(stage.writers, number)
    hit = Hit(signal.SIGKILL, chance.uniform(0, LATEST * command.seconds))
    return _hit_and_finish(command, folder, hit, chance.random() < 0.5)


def kill_resumed(stage, chance, number, folder) -> Verdict:
    """SIGKILL of a run, then of the ones that go on with it, two to four times."""
    command = stage.spread(stage.resumable, number)
    before = command.prepare(folder, with_old=False)
    found, killed = [], 0
    for _ in range(chance.randint(2, 4)):
        trip = Trip(str(folder), chance.randint(1, command.deeds))
        ended = _go_on(command, folder, Hit(trip=trip))
        killed += ended.code == KILLED
        found += faults_of_end(ended, {0, KILLED}) + faults_of_files(command, folder, before, ended)
    finished = _go_on(command, folder, Hit())
    found += faults_of_finish(command, folder, before, finished)
    return Verdict(command.name, found, 0 if found else killed)


def kill_process(stage, chance, number, folder) -> Verdict:
    """SIGKILL of a process of its own, at a random moment from its first import on."""
    command = stage.spread(stage.writers, number)
    hit = Hit(signal.SIGKILL, chance.uniform(0, 3.0))
    return _hit_and_finish(command, folder, hit, chance.random() < 0.5, run_process)


def kill_with_workers(stage, chance, number, folder) -> Verdict:
    """SIGKILL of the parent of several processes: none stays behind, and the command can be given again."""
    command = _with_workers(stage, folder, number)
    before = command.prepare(folder, with_old=False)
    hit = Hit(signal.SIGKILL, chance.uniform(0.5, 8.0))
    ended = command.run(folder, hit, run_process)
    found = faults_of_end(ended, {0, KILLED}) + _orphans(ended.group)
    found += faults_of_files(command, folder, before, ended)
    found += faults_of_finish(command, folder, before, command.finish(folder))
    return Verdict(command.name, found, not found and command.resumable and ended.code == KILLED)


def kill_a_worker(stage, chance, number, folder) -> Verdict:
    """SIGKILL of one worker of a study: it is replaced, and the study ends as if nothing had been."""
    command = _with_workers(stage, folder, 0)
    before = command.prepare(folder, with_old=False)
    hit = Hit(signal.SIGKILL, chance.uniform(2.0, 8.0), of_child=True)
    ended = command.run(folder, hit, run_process)
    found = faults_of_end(ended, {0}) + faults_of_finish(command, folder, before, ended)
    return Verdict("sweep -j 2, a worker", found)


def _with_workers(stage, folder, number):
    if number % 2:
        several = stage.commands["run several decks"]
        return Command("run several decks -j 2", (*several.arguments, "-j", "2"), several.outputs,
                       whole=several.whole)  # fmt: skip
    name = "sweep -j 2"
    if name not in stage.commands:
        arguments = ("sweep", "s.toml", "-q", "-j", "2")
        alone = Command(name, arguments[:3], ("s.h5",), {"s.toml": study(3000)}, resumable=True)
        stage.commands[name] = undisturbed(alone, folder.parent / f"whole-{folder.name}")
        alone.arguments = arguments
    return stage.commands[name]


def _orphans(group):
    """Processes of a killed parent that are still there after a while; they are ended here."""
    until = time.monotonic() + LONGEST_END
    while time.monotonic() < until:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return []
        time.sleep(0.05)
    os.killpg(group, signal.SIGKILL)
    return ["processes stay behind when their parent is killed"]


def signals_at_deeds(stage, chance, number, folder) -> Verdict:
    """SIGINT or SIGTERM just before the n-th deed."""
    command = stage.spread(stage.writers, number // 2)
    sent = (signal.SIGINT, signal.SIGTERM)[number % 2]
    trip = Trip(str(folder), chance.randint(1, command.deeds), trips.STOP, sent)
    return _hit_and_finish(command, folder, Hit(trip=trip), chance.random() < 0.5, sent=sent)


def signals_at_any_time(stage, chance, number, folder) -> Verdict:
    """SIGINT or SIGTERM at a random moment."""
    command = stage.spread(stage.writers, number // 2)
    sent = (signal.SIGINT, signal.SIGTERM)[number % 2]
    hit = Hit(sent, chance.uniform(0.01, LATEST * command.seconds))
    return _hit_and_finish(command, folder, hit, chance.random() < 0.5, sent=sent)


def signals_to_process(stage, chance, number, folder) -> Verdict:
    """SIGINT or SIGTERM to a process of its own; not while Python itself is starting."""
    command = stage.spread(stage.writers, number // 2)
    sent = (signal.SIGINT, signal.SIGTERM)[number % 2]
    hit = Hit(sent, chance.uniform(0.15, 3.0))
    verdict = _hit_and_finish(command, folder, hit, chance.random() < 0.5, run_process, sent)
    if any("KeyboardInterrupt" in fault and "flexmb_cli/" not in fault for fault in verdict.faults):
        return Verdict(command.name, skipped="Python itself was still starting")
    return verdict


def _hit_and_finish(command, folder, hit, with_old, run=run_forked, sent=signal.SIGKILL):
    """Hit the command, look at what it left, and give it again."""
    before = command.prepare(folder, with_old)
    ended = command.run(folder, hit, run)
    allowed = {0, -sent} if sent == signal.SIGKILL else {0, 128 + sent}
    if hit.sent:
        # SIGTERM before the command has begun; SIGINT as Python tells shells of it.
        allowed.add(-sent)
    found = faults_of_end(ended, allowed) + faults_of_files(command, folder, before, ended)
    finished = _go_on(command, folder, Hit())
    found += faults_of_finish(command, folder, before, finished)
    hit_at_all = ended.code != 0
    return Verdict(command.name, found, not found and hit_at_all and command.resumable)


def _go_on(command, folder, hit):
    """The command given again; a dialogue gets the answers that its draft lacks."""
    if command.name == "new":
        hit = Hit(hit.sent, hit.delay, hit.trip, stdin=_answers_left(command, folder))
        return command.run(folder, hit)
    return run_forked((*command.arguments, *command.again), folder, hit)


def _answers_left(command, folder):
    """The lines of answers behind those that the draft has, told by asking with no answers at all."""
    begun = run_forked(command.arguments, folder, Hit())
    kept = re.search(r"continuing with (\d+) answers", begun.stderr)
    left = int(kept[1]) if kept else 0
    line = 0
    while left > 0:
        left -= VALUES[line]
        line += 1
    return "".join(f"{answer}\n" for answer in ANSWERS[line:]).encode()
