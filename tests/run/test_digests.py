"""The printed tables of all shipped decks, byte for byte as they were when somebody last looked at them.

What is right is proved by the other tests; the digests tell when any of it changes.  A change on purpose is
pinned by `scripts/determinism/run digests`, which writes `digests.txt` (the form of sha256sum) anew.
"""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.processes

DECKS = Path(__file__).resolve().parents[2] / "decks"
KINDS = {"young": "*.dat", "young/dynamics": "*.dat", "dafms": "*.DAT", "vsdf": "*.vsdf"}
PINNED = {
    name: digest
    for digest, name in (line.split() for line in (Path(__file__).parent / "digests.txt").open())
}


def flexmb(folder, *arguments, **environment):
    """A command in `folder` that reduces flexible bodies anew."""
    given = {**os.environ, "FLEXMB_CACHE_DIR": str(folder / "bodies"), **environment}
    command = [sys.executable, "-m", "flexmb_cli", *map(str, arguments)]
    subprocess.run(command, cwd=folder, env=given, check=True, timeout=900)


@pytest.mark.parametrize("kind", KINDS)
def test_the_tables_of_the_shipped_decks_are_the_pinned_ones(tmp_path, kind):
    decks = sorted((DECKS / kind).glob(KINDS[kind]))
    flexmb(tmp_path, "run", "-q", "--no-h5", "-o", "results", *decks)
    tables = {f"{kind}/{path.name}": path.read_bytes() for path in (tmp_path / "results").iterdir()}
    found = {name: hashlib.sha256(table).hexdigest() for name, table in tables.items()}
    pinned = {name: digest for name, digest in PINNED.items() if name.rpartition("/")[0] == kind}
    moved = sorted(name for name in found | pinned if found.get(name) != pinned.get(name))
    assert not moved, "if the change is meant, `scripts/determinism/run digests` pins it"


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
