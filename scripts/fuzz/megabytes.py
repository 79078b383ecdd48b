"""Give flexmb files of a megabyte that are made to take long, and measure how soon it answers each.

Example: .venv/bin/python scripts/fuzz/megabytes.py
Prints processor time and exit code of each; exit 1 when one takes more than 2 s or is not answered.
"""

import sys
import tempfile
import time
from pathlib import Path

from answer import answered, without_surroundings

SIZE, SLOW = 10**6, 2.0
HEADS = {
    "young": "2 1 1 1 0 0 0 0 0 2 0 1\n",
    "dafms": "    1    2\nDFMB TITLE\n    1    0    0    0    0\n",
    "vsdf": "VSDF TITLE\nBODY\n    1 RIGD\nTABL\n",
    "study": 'deck = "x"\n[parameters]\n"a" = ',
    "listing": "TIME= 0.000\n-----\nPOSITION\nBODY       X         Y         Z         e0\n",
}
FILLINGS = {
    "one line": "1 ",
    "digits": "9",
    "blank lines": "\n",
    "the same card": "    1       1.0       1.0\n",
    "repeat counts": "999999*1.0\n",
    "open braces": "{",
    "open brackets": "[",
    "braces in pairs": "{}",
    "letters": "a",
    "bad words": "x\n",
}
COMMANDS = {"study": "sweep", "listing": "diff"}


def main() -> int:
    without_surroundings()
    late = 0
    with tempfile.TemporaryDirectory() as folder:
        for kind, head in HEADS.items():
            for name, filling in FILLINGS.items():
                late += _measured(Path(folder), kind, head, name, filling)
    return 1 if late else 0


def _measured(folder, kind, head, name, filling) -> bool:
    path = folder / "x.dat"
    path.write_text(head + filling * (SIZE // len(filling)))
    arguments = [COMMANDS.get(kind, "check"), str(path)]
    arguments += [str(path)] if kind == "listing" else []
    arguments += ["--dialect", kind] if kind not in COMMANDS else []
    start = time.process_time()
    answer = answered(arguments)
    took = time.process_time() - start
    print(f"{kind:8} {name:16} {took:6.2f} s  exit {answer.code}  {answer.fault.strip()[-80:]}", flush=True)
    return took > SLOW or bool(answer.fault)


if __name__ == "__main__":
    sys.exit(main())
