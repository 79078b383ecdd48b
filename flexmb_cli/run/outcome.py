"""What is asked of a run, and what became of it."""

import errno
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from ..errors import ANALYSIS_FAILED, DONE, INTERNAL_FAULT, LACK_OF_MEMORY, Fault, FlexmbError, ModelError
from ..read.deck import DeckText

INTERRUPTED, TERMINATED = 130, 143

KANE, ABSOLUTE = "kane", "absolute"


class Terminated(BaseException):
    """SIGTERM, raised where the program happens to be; like KeyboardInterrupt no Exception."""


class Stop:
    """What a signal asked for: KeyboardInterrupt or Terminated, None before.

    Libraries in whose midst it is raised may swallow it (HDF5 calling back for a write) or turn it into an
    exception of their own (numba compiling): a run looks here between its blocks of rows.
    `held`: it shall be noted only, for files are being opened or put in their places.
    """

    asked: type[BaseException] | None = None
    held = False

    @classmethod
    @contextmanager
    def later(cls):
        """Have a signal wait for `heed`: files of one run shall not be half old, half new."""
        cls.held = True
        try:
            yield
        finally:
            cls.held = False

    @classmethod
    def heed(cls) -> None:
        """Raise what was asked for and got lost."""
        if cls.asked is not None:
            raise cls.asked

    @classmethod
    def reason(cls, ending: BaseException) -> str:
        """Why a run ended in its midst, for the rows that are kept."""
        if cls.asked is not None or not isinstance(ending, Exception):
            return "interrupted"
        if isinstance(ending, FlexmbError):
            return str(ending)
        # What the exception says may hold a path, and a result must not.
        told = f"a fault of flexmb itself: {type(ending).__name__}"
        return LACK_OF_MEMORY if lacks_memory(ending) else told


# Fields of `KinematicSettings` by the options that set them.
SOLVER_OPTIONS = {"tolerance": "feps", "smallest_pivot": "epslu", "most_iterations": "nrmax"}


@dataclass(frozen=True)
class RunOptions:
    """The options of `flexmb run` that concern one deck.

    `solver` are fields of `KinematicSettings`, `integration` of `model.tree.Integration`; `formulation` of
    a tree: KANE or ABSOLUTE; `debug`: faults of flexmb itself are raised.
    """

    dialect: str = "auto"
    folder: str = "."
    out: str | None = None
    h5: str | None = None
    no_out: bool = False
    no_h5: bool = False
    layout: str = "safe"
    changes: tuple[str, ...] = ()
    strict: bool = False
    solver: dict = field(default_factory=dict)
    integration: dict = field(default_factory=dict)
    resume: bool = False
    formulation: str = KANE
    echo: bool = False
    debug: bool = False


@dataclass
class Outcome:
    """What became of one deck; fills while the deck is run.

    `deck` is the deck as named by the user, `settings` what `--set` changed of it, `source` its text once
    read, `echo` the list of its numbers if asked for, `statistics` what the solver counted, `resumable`
    whether `--resume` can go on with it.
    """

    deck: str
    exit_code: int = DONE
    settings: tuple[str, ...] = ()
    source: DeckText | None = None
    faults: list[Fault] = field(default_factory=list)
    files: tuple[str, ...] = ()
    rows: int = 0
    echo: str = ""
    statistics: str = ""
    resumable: bool = False
    failed_at: float | None = None
    norms: dict = field(default_factory=dict)

    @property
    def status(self) -> str:
        """The outcome in one word, for `--json`."""
        words = {0: "complete", 1: "failed", 2: "bad input", 3: "internal fault"}
        return words.get(self.exit_code, "interrupted")

    def as_dict(self) -> dict:
        """The record that `--json` prints."""
        return {
            "deck": self.deck,
            "settings": list(self.settings),
            "status": self.status,
            "exit_code": self.exit_code,
            "faults": [{"file": self.deck} | fault.as_dict() for fault in self.faults],
            "time": self.failed_at,
            "norms": self.norms,
            "rows": self.rows,
            "files": list(self.files),
        }


@dataclass(frozen=True)
class Listener:
    """Where a run tells how far it is: `begin(rows)`, `advance(rows)`, `notice(sentence)`."""

    begin: Callable[[int], None] = lambda rows: None
    advance: Callable[[int], None] = lambda rows: None
    notice: Callable[[str], None] = lambda sentence: None


def refuse_warnings(outcome: Outcome, options: RunOptions) -> None:
    """Under `--strict` the warnings so far become errors, and end the run."""
    if options.strict and any(fault.severity == "warning" for fault in outcome.faults):
        outcome.faults[:] = [
            replace(f, severity="error") if f.severity == "warning" else f for f in outcome.faults
        ]
        raise ModelError(outcome.faults)


def lacks_memory(fault: BaseException) -> bool:
    """Whether it is what numpy, imports and llvmlite raise where memory is short."""
    if isinstance(fault, OSError):
        return fault.errno in (None, errno.ENOMEM)
    return isinstance(fault, (MemoryError, ImportError)) and not isinstance(fault, ModuleNotFoundError)


def record_fault(outcome: Outcome, fault: Exception, options: RunOptions) -> None:
    """Put into `outcome` what no deck should bring about, so that the next one is tried.

    Raised again are faults of streams, which end the command, and all of them with `options.debug`.
    """
    if Stop.asked is not None:
        outcome.exit_code = INTERRUPTED if Stop.asked is KeyboardInterrupt else TERMINATED
        return
    lacking = lacks_memory(fault)
    if options.debug or (isinstance(fault, OSError) and not lacking):
        raise fault
    if lacking:
        outcome.exit_code, told = ANALYSIS_FAILED, LACK_OF_MEMORY
    else:
        outcome.exit_code = INTERNAL_FAULT
        told = (
            f"a fault of flexmb itself: {type(fault).__name__}: {fault}; please report it with the deck: "
            "`flexmb --debug …` shows where it happened"
        )
    outcome.faults.append(Fault("error", told))
