"""One answer under limits of time and memory."""

import resource
import signal
import time
from pathlib import Path

# More than a file of a megabyte may ask for, above what the libraries themselves take.
MEMORY = 768 * 2**20
GROWTH = 256 * 2**20
HOPELESS = 10.0


def outcome(kind, chance, seeds: Path, work: Path) -> dict:
    """What `kind.attempt` answers to one input: its code, the fault of flexmb, and the time it took."""
    before, start = _peak(), time.process_time()
    # Time of the processor, not of the clock: the machine may be busy.
    signal.setitimer(signal.ITIMER_PROF, HOPELESS)
    answer = kind.attempt(chance, seeds, work)
    signal.setitimer(signal.ITIMER_PROF, 0)
    took, grown = time.process_time() - start, _peak() - before
    fault = answer.fault
    if not fault and took > kind.slow:
        fault = f"slow: {took:.1f} s"
    if not fault and grown > GROWTH:
        fault = f"memory: {grown / 2**20:.0f} MB"
    return {"code": answer.code, "fault": fault, "took": took, "errors": answer.errors[-500:]}


def limit_memory() -> None:
    """Let this process take so much more and no more; the libraries must have been loaded."""
    taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (taken + MEMORY, taken + MEMORY))


def _peak():
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
