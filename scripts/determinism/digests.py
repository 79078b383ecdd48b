"""Write tests/run/digests.txt and contents.txt anew: digests of the results of all shipped decks.

Example: scripts/determinism/run digests
To be called when a table has changed on purpose; `git diff` tells which.  The form is that of sha256sum.
digests.txt is of the printed tables, contents.txt of all numbers, names and units of the HDF5 results.
Results of VSDF decks hold round-off of LAPACK, which is another with other versions of numpy and scipy; of
these the last rows of the tables are kept too, in tests/run/last_rows.txt, and contents.txt begins with the
names of both.
"""

import tempfile
from pathlib import Path

from shipped import (
    DECKS,
    KINDS,
    OF_LAPACK,
    ONE_PROCESSOR,
    content_digest,
    flexmb,
    linear_algebra,
    shipped,
    written,
)

PINNED = DECKS.parent / "tests/run"
RESULT = ".h5"


def last_rows(table: str) -> str:
    """What a listing has of its last time."""
    return table[table.rindex(" TIME =") :]


def main():
    """Run every deck and write the files."""
    with tempfile.TemporaryDirectory(prefix="flexmb-digests-") as name:
        folder = Path(name) / "results"
        for kind in KINDS:
            given = ONE_PROCESSOR | {"FLEXMB_CACHE_DIR": f"{name}/bodies"}
            flexmb("run", "-q", "-o", folder / kind, *shipped(kind), cwd=name, environment=given)
        files = written(folder)
        lines = [f"{files[name].sha256}  {name}\n" for name in files if not name.endswith(RESULT)]
        contents = [f"{content_digest(folder / name)}  {name}\n" for name in files if name.endswith(RESULT)]
        rows = [
            f"{OF_LAPACK}/{path.name}\n{last_rows(path.read_text(encoding='utf-8'))}\n"
            for path in sorted((folder / OF_LAPACK).glob("*.OUT"))
        ]
    (PINNED / "digests.txt").write_text("".join(lines), encoding="utf-8")
    contents.insert(0, f"# machine of {OF_LAPACK} results: {linear_algebra()}\n")
    (PINNED / "contents.txt").write_text("".join(contents), encoding="utf-8")
    (PINNED / "last_rows.txt").write_text("".join(rows), encoding="utf-8")


if __name__ == "__main__":
    main()
