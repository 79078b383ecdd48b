"""The printed tables of all shipped decks, byte for byte as they were when somebody last looked at them.

What is right is proved by the other tests; the digests tell when any of it changes.  A change on purpose is
pinned by `scripts/determinism/run digests`, which writes `digests.txt` (the form of sha256sum) anew.

Tables of VSDF decks hold what LAPACK leaves of zeros, which is another on other processors.  Where a digest
is another there, the last rows count, to a ten-thousandth of the largest number of a line (`last_rows.txt`).
"""

import hashlib
import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

pytestmark = pytest.mark.processes

DECKS = Path(__file__).resolve().parents[2] / "decks"
KINDS = {"young": "*.dat", "young/dynamics": "*.dat", "dafms": "*.DAT", "vsdf": "*.vsdf"}
UPDATE = "if the change is meant, `scripts/determinism/run digests` pins it"
PINNED = {
    name: digest for digest, name in (line.split() for line in (Path(__file__).parent / "digests.txt").open())
}


def flexmb(folder, *arguments, **environment):
    """A command in `folder` that reduces flexible bodies anew."""
    given = {**os.environ, "FLEXMB_CACHE_DIR": str(folder / "bodies"), **environment}
    command = [sys.executable, "-m", "flexmb_cli", *map(str, arguments)]
    subprocess.run(command, cwd=folder, env=given, check=True, timeout=900)


@pytest.fixture(scope="module")
def tables(tmp_path_factory):
    """kind → tables by their names in `digests.txt`."""

    @cache
    def of_kind(kind):
        folder = tmp_path_factory.mktemp("digests")
        decks = sorted((DECKS / kind).glob(KINDS[kind]))
        flexmb(folder, "run", "-q", "--no-h5", "-o", "results", *decks)
        return {f"{kind}/{path.name}": path.read_bytes() for path in (folder / "results").iterdir()}

    return of_kind


def moved(tables, kind):
    """Names of the tables with another digest, or none, or of no deck."""
    found = {name: hashlib.sha256(table).hexdigest() for name, table in tables.items()}
    pinned = {name: digest for name, digest in PINNED.items() if name.rpartition("/")[0] == kind}
    return sorted(name for name in found | pinned if found.get(name) != pinned.get(name))


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "vsdf"])
def test_the_tables_of_the_shipped_decks_are_the_pinned_ones(tables, kind):
    assert not moved(tables(kind), kind), UPDATE


def numbers(rows):
    """Numbers with exponents, line by line; body and node have none."""
    return [[float(word) for word in re.findall(r"\S+E[+-]\d+", line)] for line in rows.splitlines()]


def test_the_tables_of_vsdf_decks_are_the_pinned_ones_or_end_in_the_same_rows(tables):
    found = tables("vsdf")
    text = (Path(__file__).parent / "last_rows.txt").read_text(encoding="utf-8")
    names_and_rows = re.split(r"^(vsdf/.*)\n", text, flags=re.MULTILINE)[1:]
    pinned = dict(zip(names_and_rows[::2], names_and_rows[1::2], strict=True))
    assert found.keys() == pinned.keys(), UPDATE
    for name in moved(found, "vsdf"):
        table = found[name].decode()
        rows = numbers(table[table.rindex(" TIME =") :])
        expected = numbers(pinned[name].rstrip("\n"))
        assert len(rows) == len(expected), f"{name}: {UPDATE}"
        for line, other in zip(rows, expected, strict=True):
            assert line == pytest.approx(other, rel=0, abs=1e-4 * max(map(abs, other))), f"{name}: {UPDATE}"


def test_the_bytes_of_a_flexible_body_do_not_depend_on_threads(tmp_path):
    """The linear algebra below numpy adds up in another order with two threads than with one."""
    results = []
    for threads in ("1", "2"):
        folder = tmp_path / threads
        folder.mkdir()
        set_to = {"OPENBLAS_NUM_THREADS": threads, "OMP_NUM_THREADS": threads}
        flexmb(folder, "run", "-q", "--set", "time.end=0.01", DECKS / "vsdf/pendulum.vsdf", **set_to)
        results.append((folder / "pendulum.h5").read_bytes())
    assert results[0] == results[1]
