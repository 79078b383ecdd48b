"""Write tests/run/digests.txt anew: the digests of the printed tables of all shipped decks.

Example: scripts/determinism/run digests
To be called when a table has changed on purpose; `git diff` tells which.  The form is that of sha256sum.
Tables of VSDF decks hold round-off of LAPACK, which is another on other processors; of these the last rows
are kept too, in tests/run/last_rows.txt.
"""

import tempfile
from pathlib import Path

from shipped import DECKS, KINDS, flexmb, shipped, written

PINNED = DECKS.parent / "tests/run"
OF_LAPACK = "vsdf"


def last_rows(table: str) -> str:
    """What a listing has of its last time."""
    return table[table.rindex(" TIME =") :]


def main():
    """Run every deck and write the files."""
    with tempfile.TemporaryDirectory(prefix="flexmb-digests-") as name:
        folder = Path(name) / "results"
        for kind in KINDS:
            given = {"FLEXMB_CACHE_DIR": f"{name}/bodies"}
            arguments = ("run", "-q", "--no-h5", "-o", folder / kind, *shipped(kind))
            flexmb(*arguments, cwd=name, environment=given)
        lines = [f"{file.sha256}  {name}\n" for name, file in written(folder).items()]
        rows = [
            f"{OF_LAPACK}/{path.name}\n{last_rows(path.read_text(encoding='utf-8'))}\n"
            for path in sorted((folder / OF_LAPACK).iterdir())
        ]
    (PINNED / "digests.txt").write_text("".join(lines), encoding="utf-8")
    (PINNED / "last_rows.txt").write_text("".join(rows), encoding="utf-8")


if __name__ == "__main__":
    main()
