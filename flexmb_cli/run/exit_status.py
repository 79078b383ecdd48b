"""End of a deck that does not come to its last time: its reports, and its exit code."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from ..errors import ANALYSIS_FAILED, INTERNAL_FAULT, AnalysisError, Fault, FlexmbError, ModelError
from ..memory import LACK_OF_MEMORY, lack_of_memory_text, lacks_memory
from .outcome import INTERRUPTED, TERMINATED, Outcome, RunOptions, Stop, Terminated

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
