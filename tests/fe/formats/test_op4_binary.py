"""Binary OP4: files that pyYeti wrote, and files of the layouts that it does not write.

The records are those of OUTPUT4 in the DMAP Programmer's Guide of MSC Nastran.
"""

import struct
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.fe.formats.matrix_file import FEFileFault
from flexmb_cli.fe.formats.nastran_op4 import read_op4
from tests.fe.formats.test_fe_files import full

WRITTEN = sorted((Path(__file__).parent / "op4").glob("*.op4"))
K = np.array([[4.0, -1.5, 0, 0.1], [-1.5, 5.0, 0, 0], [0, 0, 3.25, 0], [0.1, 0, 0, 7.0]])
M = np.array([[2.0, 0, 0.5, 0], [0, 2.0, 0, 0], [0.5, 0, 2.0, 0], [0, 0, 0, 1e-3]])


def test_all_files_are_there():
    assert len(WRITTEN) == 6


@pytest.mark.parametrize("path", WRITTEN, ids=lambda path: path.stem)
@pytest.mark.parametrize("letter, wanted", [("K", K), ("M", M)])
def test_a_file_of_another_program_is_read_to_the_last_bit(path, letter, wanted):
    np.testing.assert_array_equal(full(read_op4(path, letter)), wanted)


class Writer:
    """Records of a file in one byte order, integers of 4 or 8 bytes, values of the type given."""

    def __init__(self, order="<", word=4, kind=2):
        self.order, self.word, self.kind = order, word, kind
        self.integer = "i" if word == 4 else "q"
        self.value = "f" if kind == 1 and word == 4 else "d"

    def record(self, integers, payload=b""):
        body = struct.pack(f"{self.order}{len(integers)}{self.integer}", *integers) + payload
        length = struct.pack(f"{self.order}i", len(body))
        return length + body + length

    def heading(self, columns, rows, name=b"KAAX"):
        return self.record((columns, rows, 6, self.kind), name.ljust(2 * self.word))

    def values(self, numbers):
        return struct.pack(f"{self.order}{len(numbers)}{self.value}", *numbers)

    def words(self, numbers):
        return len(self.values(numbers)) // self.word

    def end(self, columns):
        return self.record((columns + 1, 1, self.words([1.0])), self.values([1.0]))

    def dense(self, matrix):
        text = self.heading(len(matrix), len(matrix))
        for column, numbers in enumerate(matrix.T, start=1):
            text += self.record((column, 1, self.words(numbers)), self.values(numbers))
        return text + self.end(len(matrix))

    def strings(self, matrix, big):
        """Every number that is not zero as a string of its own."""
        text = self.heading(len(matrix), -len(matrix) if big else len(matrix))
        for column, numbers in enumerate(matrix.T, start=1):
            body = b""
            for row in np.flatnonzero(numbers):
                length = self.words([0.0])
                heads = (length + 1, row + 1) if big else (row + 1 + 65536 * (length + 1),)
                body += struct.pack(f"{self.order}{len(heads)}{self.integer}", *heads)
                body += self.values([numbers[row]])
            text += self.record((column, 0, len(body) // self.word), body)
        return text + self.end(len(matrix))


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("word", [4, 8])
@pytest.mark.parametrize("kind", [1, 2], ids=["single", "double"])
@pytest.mark.parametrize("layout", ["dense", "strings", "bigmat"])
def test_every_layout_of_the_guide_is_read(tmp_path, order, word, kind, layout):
    writer = Writer(order, word, kind)
    raw = writer.dense(K) if layout == "dense" else writer.strings(K, layout == "bigmat")
    (tmp_path / "x.op4").write_bytes(raw)
    wanted = K.astype(np.float32) if (kind, word) == (1, 4) else K
    np.testing.assert_array_equal(full(read_op4(tmp_path / "x.op4", "K")), wanted)


def reported(tmp_path, raw, letter="K"):
    (tmp_path / "x.op4").write_bytes(raw)
    with pytest.raises(FEFileFault) as refused:
        read_op4(tmp_path / "x.op4", letter)
    return str(refused.value)


def test_a_file_cut_off_is_told_with_the_byte(tmp_path):
    """32 bytes of heading, 52 a column: the last column begins at 188, the closing record at 240."""
    whole = Writer().dense(K)
    message = reported(tmp_path, whole[:-30])
    assert message == (
        "x.op4: the record at byte 188 does not end where its length says; was the file cut off?"
    )
    message = reported(tmp_path, whole[:240])
    assert message == "x.op4: matrix KAAX of 4 columns does not end; is the file cut off?"


def test_another_binary_file_is_told_from_op4(tmp_path):
    """An OP2 begins with a record of one integer."""
    message = reported(tmp_path, Writer().record((3,)) + bytes(40))
    assert message.startswith(
        "x.op4 is a binary file, but not an OP4: its first record is not of 24 or 48 bytes"
    )


def test_complex_and_oblong_matrices_are_refused(tmp_path):
    assert reported(tmp_path, Writer(kind=4).heading(4, 4)) == (
        "x.op4: matrix KAAX is complex; it must be real, type 1 or 2"
    )
    assert reported(tmp_path, Writer().heading(4, 3)) == (
        "x.op4: matrix KAAX must be square; it has 3 rows, 4 columns"
    )


def test_values_beyond_the_last_row_are_refused(tmp_path):
    writer = Writer()
    raw = writer.heading(2, 2) + writer.record((1, 2, 4), writer.values([1.0, 2.0])) + writer.end(2)
    assert reported(tmp_path, raw) == "x.op4, matrix KAAX: rows 2 to 3 of column 1 lie outside 1..2"


def test_counts_that_the_record_does_not_hold_are_refused(tmp_path):
    writer = Writer()
    raw = writer.heading(2, 2) + writer.record((1, 1, 6), writer.values([1.0, 2.0]))
    assert reported(tmp_path, raw) == "x.op4: matrix KAAX, column 1: the record claims 6 words and holds 4"


def test_a_string_of_no_length_is_refused(tmp_path):
    writer = Writer()
    raw = writer.heading(2, 2) + writer.record((1, 0, 1), struct.pack("<i", 1 + 65536))
    assert reported(tmp_path, raw) == "x.op4: column 1 has a string of 0 words"


def test_bytes_that_are_damaged_at_random_never_end_in_a_traceback(tmp_path):
    random = np.random.default_rng(7)
    for path in WRITTEN:
        for _ in range(60):
            raw = bytearray(path.read_bytes())
            for at in random.integers(0, len(raw), 3):
                raw[at] = random.integers(0, 256)
            (tmp_path / "x.op4").write_bytes(raw)
            try:
                read_op4(tmp_path / "x.op4", "K")
            except FEFileFault as fault:
                assert "x.op4" in str(fault)
