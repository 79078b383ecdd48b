"""Count the functions of the package that a command calls, and the files in which they stand.

Example: .venv/bin/python scripts/bench/functions.py --list run -q decks/young/IN4-BAR.dat
Functions are counted once, however often they are called; bodies of modules and classes, lambdas and
comprehensions are none of their own.  Compiled kernels are not seen.  Without words it counts `run -q` of
IN4-BAR, in a folder that is removed afterwards, and returns 1 where a limit is exceeded.
"""

import sys
import tempfile
from collections import Counter
from contextlib import chdir, suppress
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
PACKAGE = str(TOP / "flexmb_cli") + "/"
COMMAND = ("run", "-q", str(TOP / "decks/young/IN4-BAR.dat"))
MOST_FUNCTIONS, MOST_FILES = 330, 55


def called(words: list[str]) -> set[tuple[str, str]]:
    """Return the functions that a command calls, as (file, name with classes), in a folder of its own."""
    found = set()

    def note(frame, event, _):
        code = frame.f_code
        if event == "call" and code.co_filename.startswith(PACKAGE) and code.co_flags & 2:
            name = code.co_qualname.removesuffix(".<locals>")
            if not name.endswith(">"):
                found.add((code.co_filename.removeprefix(PACKAGE), name))

    sys.argv = ["flexmb", *words]
    sys.setprofile(note)
    with suppress(SystemExit):
        from flexmb_cli.__main__ import main

        main()
    sys.setprofile(None)
    return found


def main() -> int:
    """Print the counts."""
    words = sys.argv[1:]
    listed = words[:1] == ["--list"]
    words = words[listed:] or list(COMMAND)
    with tempfile.TemporaryDirectory(prefix="flexmb-functions-") as folder:
        words = [str(Path(word).resolve()) if Path(word).exists() else word for word in words]
        with chdir(folder):
            found = called(words)
    files = Counter(file for file, _ in found)
    if listed:
        for file in sorted(files):
            print(f"{files[file]:4d}  {file}: {' '.join(sorted(name for one, name in found if one == file))}")
    print(f"{len(found)} functions (wanted {MOST_FUNCTIONS}) in {len(files)} files (wanted {MOST_FILES})")
    return int(len(found) > MOST_FUNCTIONS or len(files) > MOST_FILES)


if __name__ == "__main__":
    sys.exit(main())
