"""Texts of HDF5 files that take more memory than the file lets expect: refused before they are read.

A reference of 16 bytes leads to a text of a megabyte, and the same text may be referred to again and again: a
file of 2 MB made `export --to mat` allocate 60 GB.
"""

import subprocess
import sys
import zlib

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.results.hdf5.chunk_bounds import TEXT_COST, bytes_of_texts
from tests.results.results import write_result

TEXT = h5py.string_dtype()
MEGABYTE = "x" * 2**20
COUNT = 60_000
PLAN = {"contiguous": {}, "chunked": {"chunks": (COUNT,)}}
PLAN["packed"] = PLAN["chunked"] | {"compression": "gzip", "shuffle": True}


def repeated(path, where, **plan):
    """Make every place of `/where` refer to one text of a megabyte.

    h5py would store the text once for each: the reference is copied in the file's own bytes.
    """
    with h5py.File(path, "r+") as file:
        if where in file:
            del file[where]
        dataset = file.create_dataset(where, shape=(COUNT,), dtype=TEXT, **plan)
        dataset[0] = MEGABYTE
        place = dataset.id.get_chunk_info(0).byte_offset if dataset.chunks else dataset.id.get_offset()
    if "compression" in plan:
        copy_packed_references(path, where)
        return
    raw = bytearray(path.read_bytes())
    raw[place : place + 16 * COUNT] = raw[place : place + 16] * COUNT
    path.write_bytes(raw)


def copy_packed_references(path, where):
    """The same in a compressed chunk, where the mask says that HDF5 passed over the filter for shuffling."""
    with h5py.File(path, "r+") as file:
        mask, raw = file[where].id.read_direct_chunk((0,))
        references = zlib.decompress(raw)[:16] * COUNT
        file[where].id.write_direct_chunk((0,), zlib.compress(references), filter_mask=mask)


def said(arguments):
    done = CliRunner().invoke(cli, list(map(str, arguments)))
    return getattr(done.exception, "exit_code", done.exit_code), done.output + str(done.exception)


COMMANDS = {
    "mat": ["export", "{r}", "--to", "mat", "-o", "{folder}/x"],
    "csv": ["export", "{r}", "--to", "csv", "-o", "{folder}/x"],
    "vtkhdf": ["export", "{r}", "--to", "vtkhdf", "-o", "{folder}/x"],
    "table": ["table", "{r}", "--list"],
    "plot": ["plot", "{r}", "-o", "{folder}/x.svg"],
    "report": ["report", "{r}", "-o", "{folder}/x"],
    "diff": ["diff", "{intact}", "{r}"],
}


@pytest.mark.parametrize("command", COMMANDS)
def test_no_command_reads_a_text_that_is_referred_to_60000_times(tmp_path, command):
    intact, result = (write_result(tmp_path / f"{name}.h5", 5) for name in ("intact", "r"))
    repeated(result, "body/name")
    words = [word.format(r=result, intact=intact, folder=tmp_path) for word in COMMANDS[command]]
    code, reported = said(words)
    assert code == 2 and "it declares 6.29e+10 bytes of numbers and text in a file of" in reported


@pytest.mark.parametrize("plan", PLAN)
def test_it_is_noticed_however_the_references_are_stored(tmp_path, plan):
    result = write_result(tmp_path / "r.h5", 5)
    repeated(result, "more", **PLAN[plan])
    with h5py.File(result) as file:
        assert file["more"].asstr()[COUNT - 1] == MEGABYTE  # the attack itself is sound
        assert bytes_of_texts(file["more"], 2**60) == COUNT * (2**20 + TEXT_COST)
    code, reported = said(["export", result, "--to", "mat", "-o", tmp_path / "x"])
    assert code == 2 and "it declares" in reported


def test_texts_that_nobody_wrote_count_as_their_fill_value(tmp_path):
    result = write_result(tmp_path / "r.h5", 5)
    with h5py.File(result, "r+") as file:
        file.create_dataset("more", shape=(COUNT,), dtype=TEXT, chunks=(10,), fillvalue=MEGABYTE)
    code, reported = said(["export", result, "--to", "mat", "-o", tmp_path / "x"])
    assert code == 2 and "it declares" in reported


def test_a_table_of_a_study_is_bounded_too(tmp_path):
    result = tmp_path / "s.h5"
    with h5py.File(result, "w") as file:
        file.attrs["Conventions"] = "flexmb-study-1"
        for name in ("case", "exit_code", "rows"):
            file[name] = np.arange(COUNT)
    repeated(result, "message")
    code, reported = said(["table", result, "message"])
    assert code == 2 and "a damaged table: it declares" in reported


@pytest.mark.parametrize("plan", PLAN.values(), ids=PLAN)
def test_true_texts_are_counted_by_their_lengths(tmp_path, plan):
    """Against the lengths of what h5py reads; some are empty, and the last are not written."""
    texts = [f"{k} é " * (k % 60) for k in range(600)]
    with h5py.File(tmp_path / "x.h5", "w") as file:
        chunks = {"chunks": (100,)} if plan else {}
        dataset = file.create_dataset("t", shape=(700,), dtype=TEXT, **plan | chunks)
        dataset[:600] = texts
    with h5py.File(tmp_path / "x.h5") as file:
        read = sum(map(len, file["t"][:]))
        assert read == sum(len(text.encode()) for text in texts)
        assert bytes_of_texts(file["t"], 2**60) == read + 700 * TEXT_COST


@pytest.mark.parametrize("name", ["message", "Conventions", "status", "a name that nobody knows"])
def test_an_attribute_of_many_texts_counts_as_none(tmp_path, name):
    """4,000 references fit into an attribute."""
    result = write_result(tmp_path / "r.h5", 5)
    with h5py.File(result, "r+") as file:
        file.attrs.create(name, ["y" * 1000] * 4000, dtype=TEXT)
    grown = peak_of(["export", result, "--to", "mat", "-o", tmp_path / "x"])
    assert grown < 300


def test_a_dataset_with_a_hundred_scales_along_an_axis_is_refused(tmp_path):
    result = write_result(tmp_path / "r.h5", 5)
    with h5py.File(result, "r+") as file:
        file["energy/total"].attrs.__delitem__("DIMENSION_LIST")
        many = np.empty(1, object)
        many[0] = np.array([file["time"].ref] * 100, h5py.ref_dtype)
        file["energy/total"].attrs.create("DIMENSION_LIST", many, dtype=h5py.vlen_dtype(h5py.ref_dtype))
    code, reported = said(["table", result, "--list"])
    assert code == 2 and "has more than 64 scales for an axis" in reported


def peak_of(arguments):
    """Largest memory, MB, of a command."""
    code = (
        "import re, sys\nfrom flexmb_cli.cli import main\n"
        f"sys.argv = ['flexmb', *{list(map(str, arguments))!r}]\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        # What getrusage tells counts the memory of the process that started this one, too.
        r"print(int(re.search(r'VmHWM:\s+(\d+)', open('/proc/self/status').read())[1]) // 1024)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=100)
    return int(done.stdout.split()[-1])


@pytest.mark.processes
def test_the_attack_of_60_gigabytes_takes_no_more_memory_than_a_small_result(tmp_path):
    result = write_result(tmp_path / "r.h5", 5)
    repeated(result, "body/name")
    assert result.stat().st_size < 2.2e6
    assert peak_of(["export", result, "--to", "mat", "-o", tmp_path / "x"]) < 300
