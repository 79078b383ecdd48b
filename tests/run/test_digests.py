"""The results of all shipped decks, byte for byte as they were when somebody last looked at them.

What is right is proved by the other tests; the digests tell when any of it changes.  A change on purpose is
pinned by `scripts/determinism/run digests`, which writes `digests.txt` of the printed tables and
`contents.txt` of numbers, names and units of the HDF5 results (the form of sha256sum) anew.

Tables of VSDF decks hold what LAPACK leaves of zeros.  Where a digest is another there, the last rows count,
to a ten-thousandth of the largest number of a line (`last_rows.txt`).  The HDF5 results of VSDF decks are
compared with the numpy and scipy of `contents.txt`.  Processors share the code of LAPACK here.
"""

import hashlib
import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import h5py
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts/determinism"))
from shipped import ONE_PROCESSOR, content_digest, linear_algebra

DECKS = Path(__file__).resolve().parents[2] / "decks"
pytestmark = pytest.mark.processes

KINDS = {"young": "*.dat", "young/dynamics": "*.dat", "dafms": "*.DAT", "vsdf": "*.vsdf"}
UPDATE = "if the change is meant, `scripts/determinism/run digests` pins it"


def pinned(name):
    """Digests of a file by the names of results."""
    lines = (Path(__file__).parent / name).read_text(encoding="utf-8").splitlines()
    return {name: digest for digest, name in (line.split() for line in lines if line[0] != "#")}


PINNED, CONTENTS = pinned("digests.txt"), pinned("contents.txt")


def flexmb(folder, *arguments, **environment):
    """A command in `folder` that reduces flexible bodies anew."""
    given = {**os.environ, **ONE_PROCESSOR, "FLEXMB_CACHE_DIR": str(folder / "bodies"), **environment}
    command = [sys.executable, "-m", "flexmb_cli", *map(str, arguments)]
    subprocess.run(command, cwd=folder, env=given, check=True, timeout=900)


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """kind → the folder with the results of its decks."""

    @cache
    def of_kind(kind):
        folder = tmp_path_factory.mktemp("digests")
        decks = sorted((DECKS / kind).glob(KINDS[kind]))
        flexmb(folder, "run", "-q", "-o", "results", *decks)
        return folder / "results"

    return of_kind


def tables_of(folder, kind):
    """Tables by their names in `digests.txt`."""
    return {f"{kind}/{path.name}": path.read_bytes() for path in folder.iterdir() if path.suffix != ".h5"}


def moved(tables, kind):
    """Names of the tables with another digest, or none, or of no deck."""
    found = {name: hashlib.sha256(table).hexdigest() for name, table in tables.items()}
    kept = {name: digest for name, digest in PINNED.items() if name.rpartition("/")[0] == kind}
    return sorted(name for name in found | kept if found.get(name) != kept.get(name))


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "vsdf"])
def test_the_results_of_the_shipped_decks_are_the_pinned_ones(folders, kind):
    folder = folders(kind)
    assert not moved(tables_of(folder, kind), kind), UPDATE
    assert contents_of(folder, kind) == pinned_contents(kind), UPDATE


def contents_of(folder, kind):
    """Digests of the HDF5 results by their names in `contents.txt`."""
    return {f"{kind}/{path.name}": content_digest(path) for path in folder.glob("*.h5")}


def pinned_contents(kind):
    """The digests that `contents.txt` has of a kind."""
    return {name: digest for name, digest in CONTENTS.items() if name.rpartition("/")[0] == kind}


def test_the_hdf5_results_of_vsdf_decks_are_the_pinned_ones_with_the_same_lapack(folders):
    found = contents_of(folders("vsdf"), "vsdf")
    assert found.keys() == pinned_contents("vsdf").keys(), UPDATE
    head = (Path(__file__).parent / "contents.txt").read_text(encoding="utf-8").splitlines()[0]
    if head.rpartition(" ")[2] != linear_algebra():
        pytest.skip(f"LAPACK rounds otherwise with {linear_algebra()}; {head[2:]}")
    assert found == pinned_contents("vsdf"), UPDATE


def test_the_digest_of_a_result_is_of_all_but_its_sentences(tmp_path):
    path, digests = tmp_path / "r.h5", []
    for sentence, label, value in (("a", "m", 1.0), ("b", "m", 1.0), ("a", "s", 1.0), ("a", "m", 1.5)):
        with h5py.File(path, "w") as file:
            file.attrs["notes"], file["x"] = sentence, [value, 2.0]
            file["x"].attrs["units"] = label
        digests.append(content_digest(path))
    assert digests[0] == digests[1]
    assert len(set(digests)) == 3


def numbers(rows):
    """Numbers with exponents, line by line; body and node have none."""
    return [[float(word) for word in re.findall(r"\S+E[+-]\d+", line)] for line in rows.splitlines()]


def test_the_tables_of_vsdf_decks_are_the_pinned_ones_or_end_in_the_same_rows(folders):
    found = tables_of(folders("vsdf"), "vsdf")
    text = (Path(__file__).parent / "last_rows.txt").read_text(encoding="utf-8")
    names_and_rows = re.split(r"^(vsdf/.*)\n", text, flags=re.MULTILINE)[1:]
    expected_rows = dict(zip(names_and_rows[::2], names_and_rows[1::2], strict=True))
    assert found.keys() == expected_rows.keys(), UPDATE
    for name in moved(found, "vsdf"):
        table = found[name].decode()
        rows = numbers(table[table.rindex(" TIME =") :])
        expected = numbers(expected_rows[name].rstrip("\n"))
        assert len(rows) == len(expected), f"{name}: {UPDATE}"
        for line, other in zip(rows, expected, strict=True):
            assert line == pytest.approx(other, rel=0, abs=1e-4 * max(map(abs, other))), f"{name}: {UPDATE}"


def results(folder, environments, *arguments):
    """The HDF5 files that a run leaves in each of the environments."""
    for k, environment in enumerate(environments):
        place = folder / str(k)
        place.mkdir()
        flexmb(place, "run", "-q", "--no-out", *arguments, **environment)
        yield {path.name: path.read_bytes() for path in place.glob("*.h5")}


def test_the_bytes_of_a_flexible_body_do_not_depend_on_threads(tmp_path):
    """The linear algebra below numpy adds up in another order with two threads than with one."""
    environments = [{"OPENBLAS_NUM_THREADS": threads, "OMP_NUM_THREADS": threads} for threads in "12"]
    deck = DECKS / "vsdf/pendulum.vsdf"
    one, two = results(tmp_path, environments, "--set", "time.end=0.01", deck)
    assert one == two and len(one) == 1


def test_the_bytes_of_rigid_bodies_do_not_depend_on_the_processor(tmp_path):
    """For a Prescott OpenBLAS adds up without the wide registers of other processors."""
    environments = [{"OPENBLAS_CORETYPE": "Prescott"}, {}]
    decks = [DECKS / "dafms/spatial_rigid.DAT", DECKS / "young/IN5BODY.dat"]
    one, other = results(tmp_path, environments, *decks)
    assert one == other and len(one) == 2
