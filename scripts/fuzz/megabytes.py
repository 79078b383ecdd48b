"""Give flexmb files of a megabyte that are made to take long, and measure how soon it answers each.

Example: scripts/fuzz/run megabytes
Prints processor time, memory and exit code of each; exit 1 when one takes more than 2 s or 256 MB, or is
not answered.  With words as arguments: only files whose kind or filling holds one of them.
"""

import os
import signal
import sys
import tempfile
import time
from pathlib import Path

from answer import answered, without_surroundings
from damaged_bricks import brick_seeds
from damaged_leftovers import draft_seeds, resume_file_seeds
from megabyte_files import Case, cases

# s, kB, s
SLOW, MOST_MEMORY, HOPELESS = 2.0, 256 * 1024, 60


def main() -> int:
    without_surroundings()
    wanted = sys.argv[1:]
    bad = total = 0
    with tempfile.TemporaryDirectory() as folder:
        seeds = Path(folder)
        for name, fill in (("bricks", brick_seeds), ("drafts", draft_seeds), ("journal", resume_file_seeds)):
            (seeds / name).mkdir()
            fill(seeds / name)
        for case in cases(seeds):
            if not wanted or any(word in f"{case.kind} {case.filling}" for word in wanted):
                total += 1
                bad += _measured(case, seeds / "work")
    print(f"{total} files, {bad} not answered as they should be")
    return 1 if bad else 0


def _measured(case: Case, work: Path) -> bool:
    """One command in a process of its own, whose time and memory the system counts."""
    work.mkdir(exist_ok=True)
    arguments, typed = case.prepare(work)
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        signal.setitimer(signal.ITIMER_PROF, HOPELESS)
        # From here on the peak is this command's.
        Path("/proc/self/clear_refs").write_text("5")
        before, start = _peak(), time.process_time()
        answer = answered(arguments, typed)
        took, grown = time.process_time() - start, _peak() - before
        os.write(write, f"{took} {grown} {answer.code} {answer.fault.strip()[-80:]}".encode())
        os._exit(0)
    os.close(write)
    with os.fdopen(read, "rb") as pipe:
        reported = pipe.read().decode() or f"{HOPELESS} 0 None not ended"
    os.waitpid(child, 0)
    took, grown, code, fault = reported.split(" ", 3)
    name = f"{case.kind:15} {case.filling:24}"
    print(f"{name} {float(took):6.2f} s {int(grown) / 1024:5.0f} MB  exit {code}  {fault}", flush=True)
    # `diff` gets two of them.
    slow = 2 * SLOW if arguments[0] == "diff" else SLOW
    return float(took) > slow or int(grown) > MOST_MEMORY or bool(fault)


def _peak():
    """Largest memory so far, kB."""
    words = Path("/proc/self/status").read_text().split()
    return int(words[words.index("VmHWM:") + 1])


if __name__ == "__main__":
    sys.exit(main())
