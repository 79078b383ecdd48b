"""Write tests/run/digests.txt anew: the digests of the printed tables of all shipped decks.

Example: scripts/determinism/run digests
To be called when a table has changed on purpose; `git diff` tells which.  The form is that of sha256sum.
"""

import tempfile
from pathlib import Path

from shipped import DECKS, KINDS, flexmb, shipped, written

PINNED = DECKS.parent / "tests/run/digests.txt"


def main():
    """Run every deck and write the file."""
    with tempfile.TemporaryDirectory(prefix="flexmb-digests-") as folder:
        for kind in KINDS:
            flexmb("run", "-q", "--no-h5", "-o", Path(folder) / kind, *shipped(kind), cwd=folder)
        lines = [f"{file.sha256}  {name}\n" for name, file in written(Path(folder)).items()]
    PINNED.write_text("".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
