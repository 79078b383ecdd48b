"""Large legal decks: how much memory and time `flexmb check` takes of each kind of content.

Example: scripts/bench/run large_decks 62 "YOUNG bodies" (megabytes, then kinds; all of them without any).
A deck of n bytes shall take at most 12 n bytes and 200 MB, and time in proportion to n.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

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
_BODY = "0 0 0 1 0 0 0\n"
# A ground, and a body that turns on it.
_COUNTS = "2 1 {points} 0 0 1 0 0 0 0 0 1\n"
_MECHANISM = "0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n2 6 0 1 0\n"
_JOINT = "1 2 0 0 0 0 0 0 0 0 1 0 0 1\n1 0 0 0 0 0 0\n0 1 0.1\n"
_YOUNG = _COUNTS.format(points=0) + _MECHANISM + _JOINT
_DECKS = Path(__file__).parents[2] / "decks"


def kinds(megabytes: int) -> dict:
    """Return functions that make a deck of about so many million bytes, by the kind of what fills it."""
    size = megabytes * 10**6
    size_of, dafms = f"{1:5d}{2:5d}\n", (_DECKS / "dafms/pendulum.DAT").read_text().split("\n", 1)[1]
    vsdf, end = (
        (_DECKS / "vsdf/pendulum.vsdf").read_text().replace(" fe/", f" {_DECKS}/vsdf/fe/").split("\nEND", 1)
    )

    def filled(text):
        return text * (size // len(text))

    def points():
        count = size // 8
        return _COUNTS.format(points=count) + _MECHANISM + count * "1 0 0 0\n" + _JOINT

    def bodies():
        count = size // 31
        grounds = "".join(f"{k} 0 0 0 0 0 0\n" for k in range(1, count + 1))
        return f"{count} 0 0 0 0 0 0 0 0 0 0 {count}\n{count * _BODY}{grounds}0 1 1\n"

    def table():
        rows = "".join(f"    1{k * 1e-3:10.3f}{k % 7:10.1f}\n" for k in range(size // 26))
        return f"{vsdf}\nTABL\n{rows}END{end}"

    return {
        "young bodies": bodies,
        "young points": points,
        "young blank lines": lambda: filled("\n") + _YOUNG,
        "young long comment": lambda: "{" + filled("a ") + "}\n" + _YOUNG,
        "young comment lines": lambda: filled("{ a comment }\n") + _YOUNG,
        "young words behind": lambda: _YOUNG + filled("some words "),
        "young lines behind": lambda: _YOUNG + filled("a\n"),
        "young other letters": lambda: "{ 𝛼 }\n" + filled("\n") + _YOUNG,
        "dafms blank lines": lambda: size_of + filled("\n") + dafms,
        "dafms skipped cards": lambda: size_of + filled("card\n") + dafms,
        "vsdf blank lines": lambda: f"{vsdf}{filled(chr(10))}\nEND{end}",
        "vsdf comments": lambda: f"{vsdf}\n{filled('* a comment' + chr(10))}END{end}",
        "vsdf table": table,
    }


def measured(text: str, dialect: str, folder: Path) -> tuple[float, int, str]:
    """Return seconds and peak of memory, bytes, of `flexmb check`, and what it says wrong; needs Linux."""
    path = folder / "large.dat"
    path.write_text(text, encoding="utf-8")
    begun = time.perf_counter()
    command = [sys.executable, "-c", _CHILD, "check", str(path), "-q", "--dialect", dialect]
    done = subprocess.run(command, capture_output=True, text=True)
    *said, peak = done.stderr.splitlines()
    fault = "\n".join(said)[:300] if done.returncode else ""
    return time.perf_counter() - begun, 1024 * int(peak.removeprefix("peak ")), fault


def main() -> int:
    """Print size, seconds, megabytes and bytes per byte beyond 200 MB of each; 1 when one takes too much."""
    megabytes, chosen = int(sys.argv[1]) if sys.argv[1:] else 8, sys.argv[2:]
    bad = 0
    with tempfile.TemporaryDirectory() as folder:
        for name, made in kinds(megabytes).items():
            if chosen and not any(word in name for word in chosen):
                continue
            text = made()
            took, peak, fault = measured(text, name.split()[0], Path(folder))
            size = len(text.encode())
            too_much = peak > MOST_PER_BYTE * size + MOST_BESIDES
            bad += bool(too_much or fault)
            told = f"{name:22} {size / 1e6:6.1f} MB {took:7.1f} s {peak / 1e6:7.0f} MB"
            print(told, "too much" if too_much else "", fault, flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
