"""Options of a run, its outcome, and the context of both that goes from the command to the analysis."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, Protocol

from ..deck.record import DeckText
from ..errors import ANALYSIS_FAILED, DONE, INTERNAL_FAULT, AnalysisError, Fault, FlexmbError, ModelError
from ..memory import LACK_OF_MEMORY, lack_of_memory_text, lacks_memory

INTERRUPTED, TERMINATED = 130, 143

KANE, ABSOLUTE = "kane", "absolute"
FROM_EQUILIBRIUM = "from-equilibrium"
LOOP_TOLERANCE = "loop-tolerance"


class Terminated(BaseException):
    """SIGTERM, raised where the program happens to be; like KeyboardInterrupt no Exception."""


class Stop:
    """The stop that a signal requested: `asked` is KeyboardInterrupt or Terminated, None before.

    `held` counts the blocks of code in which a stop is only noted.  It is raised at once while a deck is read
    or solved (`released`), and delayed while files and records are written, so that none is left half done.
    A library may swallow the exception (HDF5 in a callback) or replace it by one of its own (numba while it
    compiles): therefore a run also looks here between its blocks of rows.
    """

    asked: type[BaseException] | None = None
    held = 0

    @classmethod
    @contextmanager
    def later(cls) -> Iterator[None]:
        """Have a signal wait for `raise_if_asked`."""
        cls.held += 1
        try:
            yield
        finally:
            cls.held -= 1

    @classmethod
    @contextmanager
    def released(cls) -> Iterator[None]:
        """Have a signal raised at once, also one that has come already."""
        before = cls.held
        try:
            cls.held = 0
            cls.raise_if_asked()
            yield
        finally:
            cls.held = before

    @classmethod
    def too_late(cls) -> None:
        """Ignore stops from here to the end of `released`: all rows are written."""
        cls.held += 1

    @classmethod
    def raise_if_asked(cls) -> None:
        """Raise a stop that was noted, unless stops are held."""
        if cls.asked is not None and not cls.held:
            raise cls.asked

    @classmethod
    def code(cls) -> int:
        """Return the exit code of the stop."""
        return INTERRUPTED if cls.asked is KeyboardInterrupt else TERMINATED


# Fields of `KinematicSettings` by the options that set them.
SOLVER_OPTIONS = {"tolerance": "feps", "smallest_pivot": "epslu", "most_iterations": "nrmax"}


@dataclass(frozen=True)
class RunOptions:
    """The options of `flexmb run` that concern one deck.

    `solver` are fields of `KinematicSettings`, `integration` of `model.tree.Integration`; `formulation` of
    a tree: KANE or ABSOLUTE; `as_printed`: a YOUNG deck is solved with the errors of the program of 1996;
    `debug`: faults of flexmb itself are raised; `only`: names of quantities that the HDF5 result holds, all
    without any; `force`: files that flexmb did not make are replaced, too;
    `from_equilibrium`: the motion begins at rest.
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
    solver: dict[str, Any] = field(default_factory=dict)
    integration: dict[str, Any] = field(default_factory=dict)
    resume: bool = False
    formulation: str = KANE
    estimate_error: bool = False
    as_printed: bool = False
    echo: bool = False
    debug: bool = False
    only: tuple[str, ...] = ()
    force: bool = False
    loop_tolerance: float | None = None
    from_equilibrium: bool = False

    @property
    def given_numbers(self) -> tuple[tuple[str, object], ...]:
        """The options given on which numbers depend, as the command has them, and their values.

        A flag has the value None.
        """
        solver = ((SOLVER_OPTIONS.get(key, key), value) for key, value in self.solver.items())
        formulation = () if self.formulation == KANE else (("formulation", self.formulation),)
        flags: tuple[tuple[str, object], ...] = (("as-printed", None),) if self.as_printed else ()
        flags += ((FROM_EQUILIBRIUM, None),) if self.from_equilibrium else ()
        loops = () if self.loop_tolerance is None else ((LOOP_TOLERANCE, self.loop_tolerance),)
        return (*solver, *flags, *self.integration.items(), *formulation, *loops)


@dataclass
class Outcome:
    """Outcome of one deck; fills while the deck is run.

    `deck` is the deck as named by the user, `settings` what `--set` changed of it, `system` the units that it
    says, `source` its text once read, `echo` the list of its numbers if asked for, `statistics` what the
    solver counted, `resumable` whether `--resume` can continue it, `errors` the largest global errors by the
    paths of their datasets, `as_printed` whether it was solved with the errors of the program of 1996,
    `notices` what was reported on the way: about the machine and not the deck, so that neither results nor
    `--strict` know it.
    """

    deck: str
    exit_code: int = DONE
    settings: tuple[str, ...] = ()
    system: str = ""
    source: DeckText | None = None
    faults: list[Fault] = field(default_factory=list)
    files: tuple[str, ...] = ()
    rows: int = 0
    echo: str = ""
    statistics: str = ""
    resumable: bool = False
    errors: dict[str, Any] = field(default_factory=dict)
    failed_at: float | None = None
    norms: dict[str, Any] = field(default_factory=dict)
    as_printed: bool = False
    notices: list[Fault] = field(default_factory=list)

    @property
    def lines(self) -> Sequence[str]:
        """The lines of the deck once it is read, for places."""
        return self.source.lines if self.source else ()

    @property
    def status(self) -> str:
        """The outcome in one word, for `--json`."""
        words = {0: "complete", 1: "failed", 2: "bad input", 3: "internal fault"}
        return words.get(self.exit_code, "interrupted")

    def as_dict(self) -> dict[str, Any]:
        """The record that `--json` prints."""
        return {
            "deck": self.deck,
            "settings": list(self.settings),
            "status": self.status,
            "exit_code": self.exit_code,
            "faults": [
                {"file": self.deck} | fault.as_dict(self.lines) for fault in (*self.faults, *self.notices)
            ],
            "time": self.failed_at,
            "norms": self.norms,
            "rows": self.rows,
            "files": list(self.files),
            **({"global_error": self.errors} if self.errors else {}),
            **({"as_printed": True} if self.as_printed else {}),
        }


@dataclass(frozen=True)
class Listener:
    """Listener to the progress of a run: `begin(rows)`, `advance(rows)`, `notice(fault)`, `status(doing)`.

    A notice stays; a status holds until the first row.
    """

    begin: Callable[[int], None] = lambda rows: None
    advance: Callable[[int], None] = lambda rows: None
    notice: Callable[[Fault], None] = lambda fault: None
    status: Callable[[str], None] = lambda doing: None

    def kept_in(self, notices: list[Fault]) -> "Listener":
        """Return a listener that keeps notices, too."""

        def notice(fault: Fault) -> None:
            notices.append(fault)
            self.notice(fault)

        return replace(self, notice=notice)


def refuse_warnings(outcome: Outcome, options: RunOptions) -> None:
    """Under `--strict` turn the warnings so far into errors, and raise ModelError."""
    if options.strict and any(fault.severity == "warning" for fault in outcome.faults):
        outcome.faults[:] = [
            replace(f, severity="error") if f.severity == "warning" else f for f in outcome.faults
        ]
        raise ModelError(outcome.faults)


class TextStream(Protocol):
    """Destination of a listing that is not written to a file."""

    def write(self, text: str, /) -> int:
        """Write `text`."""

    def flush(self) -> None:
        """Pass buffered text on."""


class Run(NamedTuple):
    """The context of one deck."""

    outcome: Outcome  # fills while the deck is run
    options: RunOptions  # those of the command
    listener: Listener = Listener()  # receives its progress
    stdout: TextStream | None = None  # receives the listing of `--out -`

    def warn(self, faults: list[Fault] | tuple[Fault, ...]) -> None:
        """Record warnings; under `--strict` they end the run as errors.  Raises ModelError."""
        self.outcome.faults += faults
        refuse_warnings(self.outcome, self.options)

    @property
    def with_new_outcome(self) -> "Run":
        """The same run with an empty outcome, for a second solution that reports nothing to the user."""
        return self._replace(outcome=Outcome(self.outcome.deck))


_REPORT = "please report it with the deck: `flexmb --debug …` shows where it happened"


class StreamError(OSError):
    """A standard stream cannot be written: that ends the command, not one of its decks."""


@contextmanager
def ending_recorded(outcome: Outcome, options: RunOptions) -> Iterator[None]:
    """Whatever ends a deck in here goes into its `outcome`, so that the next one is tried.

    Raised on are a StreamError, and with `options.debug` faults of flexmb itself.
    """
    try:
        yield
    except FlexmbError as failure:
        _record_failure(outcome, failure, options)
    except KeyboardInterrupt:
        outcome.exit_code = INTERRUPTED
    except Terminated:
        outcome.exit_code = TERMINATED
    except Exception as fault:
        _record_fault(outcome, fault, options)


def reason_of(ending: BaseException) -> str:
    """Return why a run ended in its midst, for the rows that are kept."""
    if Stop.asked is not None or not isinstance(ending, Exception):
        return "interrupted"
    if isinstance(ending, FlexmbError):
        return str(ending)
    # What the exception says may hold a path, and a result must not.
    if lacks_memory(ending):
        return LACK_OF_MEMORY
    if isinstance(ending, OSError):
        return f"the system refused: {ending.strerror}"
    return f"a fault of flexmb itself: {type(ending).__name__}"


def _record_failure(outcome: Outcome, failure: FlexmbError, options: RunOptions) -> None:
    known = set(outcome.faults)
    faults = [fault for fault in failure.faults if fault not in known]
    if isinstance(failure, ModelError | AnalysisError):
        faults = [_by_change(fault, options) for fault in faults]
    outcome.faults += faults
    outcome.exit_code = failure.exit_code
    if isinstance(failure, AnalysisError):
        outcome.failed_at, outcome.norms = failure.time, failure.norms
    if outcome.exit_code == INTERNAL_FAULT and options.debug:
        raise failure


def _by_change(fault: Fault, options: RunOptions) -> Fault:
    """A fault of the model, where numbers were changed, may be theirs; the line shown has the old ones."""
    reported = any(change in fault.message for change in options.changes)
    if options.changes and fault.severity == "error" and not reported:
        return replace(
            fault, message=f"{fault.message} (numbers changed by --set: {', '.join(options.changes)})"
        )
    return fault


def _record_fault(outcome: Outcome, fault: BaseException, options: RunOptions) -> None:
    """A stop that became another exception, or a fault of the machine or of flexmb itself."""
    if Stop.asked is not None:
        outcome.exit_code = Stop.code()
        return
    if options.debug or isinstance(fault, StreamError):
        raise fault
    outcome.exit_code = ANALYSIS_FAILED
    if lacks_memory(fault):
        reported = lack_of_memory_text(fault)
    elif isinstance(fault, OSError):
        named = f": {fault.filename}" if fault.filename else ""
        reported = f"the system refused: {fault.strerror}{named}"
    else:
        outcome.exit_code = INTERNAL_FAULT
        reported = f"a fault of flexmb itself: {type(fault).__name__}: {fault}; {_REPORT}"
    outcome.faults.append(Fault("error", reported, id="RUN-016"))
