"""Small files whose chunks or names would take gigabytes: refused before libhdf5 reads them.

Each took more than 4 GB for `export --to mat`, from files of 0.03 to 4 MB.
"""

import zlib

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.results.hdf5 import chunk_bounds
from tests.results.results import write_result

ROWS = 5
ZEROS = 2**27  # bytes; the zlib manual's 1032 : 1 makes them 0.13 MB


def packed(file, path, raw, deflates=1):
    """Make a dataset of five numbers of whose only chunk the file holds `raw`.

    HDF5 1.14 writes the length of `raw` in as many bytes as that of the chunk, 8,000, has, and one more.
    """
    del file[path]
    plan = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    plan.set_chunk((1000,))
    for _ in range(deflates):
        plan.set_deflate(9)
    space, kind = h5py.h5s.create_simple((ROWS,), (h5py.h5s.UNLIMITED,)), h5py.h5t.NATIVE_DOUBLE
    h5py.h5d.create(file.id, path.encode(), kind, space, plan).write_direct_chunk((0,), raw)


def long_chunk(file):
    """libhdf5 inflates what the chunk holds, then compares."""
    packed(file, "energy/total", zlib.compress(bytes(ZEROS), 9))


def packed_twice(file):
    packed(file, "energy/total", zlib.compress(zlib.compress(bytes(ZEROS), 9), 9), deflates=2)


def chunks_of_one(file):
    """A record of each chunk that is read, also of those that nobody wrote."""
    file.create_dataset("more", shape=(2**20,), chunks=(1,), dtype="f8")


def long_paths(file):
    """The name of the group is stored once and stands in 2,000 paths."""
    group = file.create_group("x" * 40_000)
    dataset = group.create_dataset("d", data=np.zeros(1))
    for k in range(2000):
        group[str(k)] = dataset


def long_empty_axis(file):
    """No number at all, which MATLAB's header cannot describe: export ended with a fault of flexmb."""
    file.create_dataset("more", shape=(0, 2**40), chunks=(1, 1), maxshape=(None, None), dtype="f8")


def filter_with_sizes(file):
    file.create_dataset("more", data=np.arange(1000), scaleoffset=0)


ATTACKS = {
    long_chunk: "has a chunk that unpacks to more than it holds",
    packed_twice: "is packed several times",
    chunks_of_one: "it declares 1.08e+09 bytes",
    long_paths: "the paths of its datasets take",
    long_empty_axis: "declares an axis of 1099511627776 places",
    filter_with_sizes: "is packed by a filter other than deflate, shuffle and Fletcher-32",
}


@pytest.mark.parametrize("attack", ATTACKS)
def test_a_small_file_that_would_take_gigabytes_is_refused(tmp_path, attack):
    result = write_result(tmp_path / "r.h5", ROWS)
    with h5py.File(result, "r+") as file:
        attack(file)
    for words in (["export", result, "--to", "mat", "-o", tmp_path / "x"], ["diff", result, result]):
        done = CliRunner().invoke(cli, list(map(str, words)))
        assert getattr(done.exception, "exit_code", done.exit_code) == 2
        assert ATTACKS[attack] in done.output + str(done.exception)


@pytest.mark.parametrize("shuffle", [False, True])
def test_packed_results_are_read(tmp_path, monkeypatch, shuffle):
    """As `h5repack` packs them; noise hardly shrinks, so that each chunk is looked at."""
    monkeypatch.setattr(chunk_bounds, "INFLATED", 10**9)
    result = write_result(tmp_path / "r.h5", ROWS)
    with h5py.File(result, "r+") as file:
        noise = np.random.default_rng(1).random(1000)
        file.create_dataset(
            "more", data=noise, chunks=(300,), compression="gzip", shuffle=shuffle, fletcher32=True
        )
    done = CliRunner().invoke(cli, ["export", str(result), "--to", "mat", "-o", str(tmp_path / "x.mat")])
    assert done.exit_code == 0
