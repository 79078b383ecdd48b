"""Finite-element files that are damaged or made to harm: refused in words, at once, in little memory."""

import os
import struct
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.modes import modes
from flexmb_cli.fe.formats import file_text
from flexmb_cli.fe.formats.connectivity import read_elements
from flexmb_cli.fe.formats.formats import read_matrix
from flexmb_cli.fe.formats.matrix_file import FEFileFault, MatrixFile
from flexmb_cli.fe.formats.node_table import read_node_table
from flexmb_cli.fe.nodal_matrices import nodal_part

LONG = "9" * 5000  # int() of Python refuses more than 4300 digits by an exception of its own
HUGE = "99999999999999999999"  # more than int64 holds
MARKET = "%%MatrixMarket matrix coordinate real symmetric\n"
HEADING = f"{2:14d}{1:14d}{0:14d}{1:14d}{0:14d}\nRSA{'':11}{{}}\n(1I14)          (1I14)          (1D25.15)\n"
OP4_END = "       2       1       2\n 1.0\n"
OP4 = "       1       1       6       2K       1P,3E23.16\n"
MATRICES = {
    "a size of a milliard rows": ("MM", MARKET + "1000000000 1000000000 1\n1 1 2.0\n", "1 entries"),
    "a size beyond all integers": ("MM", MARKET + "1e300 1e300 1\n1 1 2.0\n", "whole numbers"),
    "a matrix without entries": ("MM", MARKET + "1 1 0\n", "1 rows and 0 entries"),
    "an index beyond all integers": ("MM", MARKET + f"1 1 1\n{HUGE} 1 2.0\n", "whole numbers"),
    "an array of a milliard rows": (
        "MM", "%%MatrixMarket matrix array real general\n1000000000 1000000000\n1.0\n", "announces",
    ),
    "Abaqus rows to a milliard": ("ABQ", "1000000000, 1000000000, 1.0\n", "1000000000 rows and 1 entries"),
    "an Abaqus direction 0": ("ABQ", "1,0,1,1,2.0\n", "count from 1"),
    "an Abaqus row 0": ("ABQ", "0,1,2.0\n", "count from 1"),
    "a DMIG point of too many digits": (
        "DMIG", f"DMIG,K,0,6,2,0\nDMIG,K,{LONG},1,,1,1,1.0\n", "expected a grid point",
    ),
    "a DMIG component with an underscore": (
        "DMIG", "DMIG,K,0,6,2,0\nDMIG,K,1_0,1,,1,1,1.0\n", "expected a grid point",
    ),
    "OP4 text without a width": ("OP4", OP4.replace("E23", "E0"), "expected"),
    "OP4 text with a negative width": ("OP4", OP4.replace("E23", "E-3"), "expected"),
    "an OP4 column of fewer values than it announces": (
        *("OP4", OP4 + "       1       1       4\n 1.0\n" + OP4_END, "announces 4 words and holds 1 values"),
    ),
    "an OP4 column of minus two words": (
        *("OP4", OP4 + "       1       1      -2\n 1.0\n" + OP4_END, "announces -2 words"),
    ),
    "an OP4 column 0": ("OP4", OP4 + "       0       1       2\n 1.0\n" + OP4_END, "column 0"),
    "OP4 with a milliard of columns": (
        "OP4",
        2 * f"{99999998:8d}" + f"{6:8d}{2:8d}K       1P,3E23.16\n99999999 1 1\n 1.0\n", " 0 entries",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", MATRICES)
def test_a_matrix_is_refused_in_words_and_without_memory(tmp_path, case):
    form, text, reported = MATRICES[case]
    (tmp_path / "x").write_text(text)
    tracemalloc.start()
    with pytest.raises(FEFileFault, match=reported):
        read_matrix(tmp_path / "x", form, "K")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 10e6


def test_a_binary_op4_of_two_milliard_columns_takes_no_memory(tmp_path):
    def record(*integers, payload=b""):
        body = struct.pack(f"<{len(integers)}i", *integers) + payload
        return struct.pack("<i", len(body)) + body + struct.pack("<i", len(body))

    end = record(2**31 - 1, 1, 2, payload=struct.pack("<d", 1.0))
    (tmp_path / "x").write_bytes(record(2**31 - 2, 2**31 - 2, 6, 2, payload=b"K       ") + end)
    with pytest.raises(FEFileFault, match="0 entries"):
        read_matrix(tmp_path / "x", "OP4", "K")


MAPPING = "1 1 UX\n"
BOEING = {
    "negative counts": ("title\n" + HEADING.format(f"{1:14d}{1:14d}{-1:14d}{0:14d}"), "not negative"),
    "fields without width": (
        "title\n" + HEADING.format(f"{1:14d}{1:14d}{1:14d}{0:14d}").replace("1I14", "1I00"), "no FORTRAN",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", BOEING)
def test_a_harwell_boeing_heading_is_refused_in_words(tmp_path, case):
    text, reported = BOEING[case]
    (tmp_path / "x").write_text(text + "             1\n" * 3)
    (tmp_path / "map").write_text(MAPPING)
    with pytest.raises(FEFileFault, match=reported):
        read_matrix(tmp_path / "x", "HB", "K", tmp_path / "map", "ANS")


TABLES = {
    "a number of too many digits": ("TXT", f"{LONG} 0 0 0\n"),
    "a number beyond int64": ("TXT", f"1{HUGE} 0 0 0\n"),
    "a position that is not finite": ("TXT", "1 1e999 0 0\n"),
    "a position beyond all products": ("TXT", "1 1e308 0 0\n"),
    "a number with an underscore": ("TXT", "1 1_0 0 0\n"),
    "an archive with a field of no width": ("CDB", "NBLOCK,6\n(3i9,6e0.1)\n        1\n"),
    "an archive with a width of too many digits": ("CDB", f"NBLOCK,6\n(3i{LONG},6e20.1)\n        1\n"),
    "an archive with a position that is not finite": (
        "CDB",
        "NBLOCK,6\n(3i9,6e20.13)\n" + f"{1:9d}{0:18d}{'nan':>20}\n-1\n",
    ),
    "a grid point of too many digits": ("BDF", f"GRID,{LONG},,0.,0.,0.\n"),
}


@pytest.mark.parametrize("case", TABLES)
def test_a_node_table_is_refused_at_its_line(tmp_path, case):
    form, text = TABLES[case]
    (tmp_path / "x").write_text(text)
    with pytest.raises(FEFileFault, match=r"x, line \d: .*(expected|be real|not a? ?finite|farther off)"):
        read_node_table(tmp_path / "x", form)


@pytest.mark.parametrize(
    "form, text",
    [
        ("INP", f"*ELEMENT, TYPE=C3D8\n1, {LONG}, 2, 3, 4, 5, 6, 7, 8\n"),
        ("CDB", f"EBLOCK\n(19i9)\n{HUGE}\n       -1\n"),
    ],
)
def test_elements_of_too_many_digits_are_refused_at_their_line(tmp_path, form, text):
    (tmp_path / "x").write_text(text)
    with pytest.raises(FEFileFault):
        read_elements(tmp_path / "x", form)


def pipe(folder):
    os.mkfifo(folder / "x")
    return folder / "x"


PLACES = {
    "a folder": lambda folder: folder,
    "a pipe without a writer": pipe,
    "a device without end": lambda folder: "/dev/zero",
    "standard input": lambda folder: "/dev/stdin",
}


@pytest.mark.parametrize("case", PLACES)
def test_what_is_no_regular_file_is_refused_instead_of_waited_for(tmp_path, case):
    """A deck names these files: one in a stranger's deck must not hold a run for ever."""
    (tmp_path / "link").symlink_to(PLACES[case](tmp_path))
    with pytest.raises(FEFileFault, match=r"not a regular file|cannot be read"):
        file_text.bytes_of(tmp_path / "link")


def test_a_file_larger_than_the_bound_is_refused_before_it_is_read(tmp_path):
    with open(tmp_path / "x", "wb") as stream:
        stream.truncate(file_text.LARGEST_FILE)
    with pytest.raises(FEFileFault, match="2 GB"):
        file_text.bytes_of(tmp_path / "x")


@pytest.mark.parametrize(
    "spelt, value", [("1.5D+03", 1500.0), ("1.5+3", 1500.0), (" .5", 0.5), ("2e-1", 0.2)]
)
def test_numbers_are_read_as_fortran_writes_them(spelt, value):
    assert file_text.real(spelt) == value


@pytest.mark.skipif(not Path("/proc/self/pagemap").is_file(), reason="no /proc here")
@pytest.mark.parametrize("name", ["/proc/self/pagemap", "/proc/kmsg", "/proc/self/status"])
def test_a_file_without_a_length_is_empty(name):
    """Linux, proc(5): length 0 is told; pagemap goes on for 2^36 bytes and more, kmsg blocks without news."""
    try:
        assert file_text.bytes_of(Path(name)) == b""
    except FEFileFault as fault:
        assert "cannot be read: " in str(fault)  # by others than root


BEAM = (
    "GRID,1,,0.,0.,0.\nGRID,2,,.3,0.,0.\nPBAR,8,1,2.-4,1.-8,{0},1.-8\nCBAR,2,8,1,2,0.,0.,{1}\n"
    "MAT1,1,2.+9,,.3,1000.\n"
)


@pytest.mark.parametrize(
    ("inertia", "upward", "words"), [("1.+308", "1.", "not finite"), ("2.-8", "1.+999", "along the beam")]
)
def test_beams_whose_products_overflow_are_refused(tmp_path, inertia, upward, words):
    (tmp_path / "x.bdf").write_text(BEAM.format(inertia, upward))
    text = (
        "VSDF x\nBODY\n    1 FLEX    4\nFEMN\n    1 BDF  x.bdf\nMATL\n    1     2e+09       0.3    1000.0\n"
    )
    (tmp_path / "x.vsdf").write_text(f"{text}TIME\n0.01,0.005\nEND\nSTAR\nSTOP\n")
    done = CliRunner().invoke(modes, [str(tmp_path / "x.vsdf")])
    assert done.exit_code == 2
    assert words in done.output


def test_rows_of_rotations_without_entries_are_none_of_the_next_node():
    """Nodes 1 and 2, translations of both in tension, and a row of a rotation of the first that holds 0."""
    labels = np.array([*((n, c) for n in (1, 2) for c in (1, 2, 3)), (1, 4)])
    values = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.0])
    file = MatrixFile(7, np.arange(7), np.arange(7), values, True, labels)
    part = nodal_part("M", file, np.array([1, 2]))
    assert np.diag(np.asarray(part.matrix)).tolist() == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
