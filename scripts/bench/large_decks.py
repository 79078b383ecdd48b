"""Large legal decks: how much memory and time `flexmb check` takes of each kind of content.

Example: scripts/bench/run large_decks 62 "young bodies" (megabytes, then kinds; all of them without any).
A deck that reaches a limit of its format before is smaller; one that is refused makes the script fail.
"young all FORCE" and its like are decks of the shortest cards of every word, right or wrong.
A deck of n bytes shall take at most 12 n bytes and 200 MB, and time in proportion to n.
"""

import os
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from large_card_kinds import card_kinds
from large_kinds import kinds

# Faults that end the reading, so that nothing is measured, and those of flexmb itself.
_LEFT_UNREAD = re.compile(
    "a fault of flexmb|not enough memory|not read from here on|are taken|more than [0-9]+ c"
)
MOST_PER_BYTE, MOST_BESIDES = 12, 200 * 10**6

# The process itself tells its peak: what the system tells its parent counts the parent's own memory, too.
_CHILD = """
import re, sys
from flexmb_cli.__main__ import main
sys.argv[0] = "flexmb"
try:
    main()
finally:
    print("peak", re.search(r"VmHWM:\\s+(\\d+)", open("/proc/self/status").read())[1], file=sys.stderr)
"""


def measured(text: str, dialect: str, folder: Path, *words: str) -> tuple[float, int, str]:
    """Return processor time, s, and peak of memory, bytes, of `flexmb check`, and its faults; needs Linux."""
    path = folder / "large.dat"
    path.write_text(text, encoding="utf-8")
    command = [sys.executable, "-c", _CHILD, "check", str(path), "-q", "--dialect", dialect, *words]
    begun = resource.getrusage(resource.RUSAGE_CHILDREN)
    # Huge pages count in full, and the system gives them as it has some: 2 MB of chance for each large array.
    # The records of coverage (4 to 8 MB) are no memory of flexmb.
    given = {name: value for name, value in os.environ.items() if not name.startswith("COVERAGE_")}
    given["NUMPY_MADVISE_HUGEPAGE"] = "0"
    # The C library moves its threshold of mapped blocks: a path of 20 letters more or less changed 2 MB.
    given["MALLOC_MMAP_THRESHOLD_"] = "131072"
    done = subprocess.run(command, env=given, capture_output=True, text=True)
    *said, peak = done.stderr.splitlines()
    fault = "\n".join(said)[:300] if done.returncode else ""
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime
    return seconds, 1024 * int(peak.removeprefix("peak ")), fault


def _may_be(name: str, fault: str) -> bool:
    """Return whether the fault of a deck may be: a right one has none, a wrong one is read as a whole."""
    return not fault or (" all " in name and not _LEFT_UNREAD.search(fault))


def main() -> int:
    """Print size, seconds, megabytes and bytes per byte beyond 200 MB of each; 1 when one takes too much."""
    megabytes, chosen = int(sys.argv[1]) if sys.argv[1:] else 8, sys.argv[2:]
    bad = 0
    with tempfile.TemporaryDirectory() as folder:
        for name, made in (*kinds(megabytes).items(), *card_kinds(megabytes * 10**6)):
            if chosen and not any(word in name for word in chosen):
                continue
            text = made()
            took, peak, fault = measured(text, name.split()[0], Path(folder))
            size = len(text.encode())
            too_much = peak > MOST_PER_BYTE * size + MOST_BESIDES
            bad += bool(too_much or not _may_be(name, fault))
            reported = f"{name:22} {size / 1e6:6.1f} MB {took:7.1f} s {peak / 1e6:7.0f} MB"
            print(reported, "too much" if too_much else "", fault, flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
