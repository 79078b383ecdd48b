"""Bytes to text: character codes, sizes, and files that are none."""

import hashlib
import io
import os
import sys

import pytest

from flexmb_cli.deck import text
from flexmb_cli.deck.record import DeckText
from flexmb_cli.deck.text import decode, read_text
from flexmb_cli.errors import DeckError, Place


def message(path):
    with pytest.raises(DeckError) as refused:
        read_text(path)
    (fault,) = refused.value.faults
    return fault.message, fault.place


def test_a_deck_has_its_file_name_its_text_and_the_digest_of_its_bytes(tmp_path):
    path = tmp_path / "IN1.dat"
    path.write_bytes(b"1 2\r\n3")
    deck = read_text(path)
    assert (deck.name, deck.text, list(deck.lines)) == ("IN1.dat", "1 2\r\n3", ["1 2", "3"])
    assert deck.sha256 == hashlib.sha256(b"1 2\r\n3").hexdigest()


def test_standard_input_is_called_a_dash(monkeypatch):
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"1 2")))
    assert read_text("-").name == "-"


def test_a_byte_order_mark_is_no_character_of_the_deck():
    assert decode("x", b"\xef\xbb\xbf12").text == "12"


def test_text_that_is_not_utf_8_is_latin_1_with_a_warning_at_the_character():
    deck = decode("x", b"1\r\n{ \xb5 }")
    assert list(deck.lines) == ["1", "{ µ }"]
    (warning,) = deck.warnings
    assert (warning.severity, warning.place) == ("warning", Place(2, 3))
    assert warning.message == "the deck is not UTF-8 and is read as Latin-1"


def test_a_nul_byte_is_not_text():
    with pytest.raises(DeckError) as refused:
        decode("x", "1\n2".encode("utf-16-le"))
    (fault,) = refused.value.faults
    assert fault.place == Place(1, 2)
    assert fault.message.startswith("the deck holds a NUL byte, so it is not text; save it as UTF-8")


def test_a_missing_file_has_no_place(tmp_path):
    assert message(tmp_path / "none.dat") == ("no such file", None)


def test_a_directory_is_no_deck(tmp_path):
    assert message(tmp_path) == (
        f"is a directory, not a deck; give the files in it, such as {tmp_path}/*",
        None,
    )


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may read everything")
def test_a_file_without_permission_says_so(tmp_path):
    path = tmp_path / "secret.dat"
    path.write_text("1")
    path.chmod(0)
    assert message(path) == ("permission denied", None)


def test_a_file_below_a_file_is_explained_by_the_system(tmp_path):
    (tmp_path / "a").write_text("1")
    assert message(tmp_path / "a" / "b")[0] == f"cannot be read: {os.strerror(20)}"


def test_a_name_that_no_file_can_have_is_refused():
    assert message("a\0b") == ("cannot be read: the name is not a file name", None)


def test_a_huge_file_is_refused_by_its_size_before_it_is_read(tmp_path, monkeypatch):
    path = tmp_path / "huge.dat"
    with path.open("wb") as stream:
        stream.truncate(text.LARGEST_DECK + 1)
    monkeypatch.setattr(text, "_first_bytes", lambda stream: pytest.fail("the file was read"))
    assert message(path) == ("larger than 64 MB, which no deck is", None)


def test_a_pipe_that_never_ends_is_refused_too(monkeypatch):
    monkeypatch.setattr(text, "LARGEST_DECK", 10)
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"1 " * 10)))
    assert message("-")[0].startswith("larger than")


@pytest.mark.parametrize("ends", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("behind", ["", "end"])
def test_lines_are_cut_out_of_the_text_wherever_they_are_asked_for(ends, behind):
    wanted = [f"line {k}" for k in range(600)] + ["", "", behind]
    whole = ends.join(wanted)
    lines = DeckText("x", whole, "").lines
    assert list(lines) == wanted and len(lines) == len(wanted)
    assert [lines[k] for k in (599, 0, 255, 256, 3, -1)] == [wanted[k] for k in (599, 0, 255, 256, 3, -1)]
    assert lines[598:602] == wanted[598:602] and list(lines.after(598)) == wanted[598:]
    assert lines.place_of(whole.index("line 57") + 5) == (58, 6)
    with pytest.raises(IndexError):
        lines[len(wanted)]


def test_line_ends_of_all_kinds_may_stand_in_one_text():
    lines = DeckText("x", "a\r\r\nb\n\rc\r\n", "").lines
    assert list(lines) == ["a", "", "b", "", "c", ""] == [lines[k] for k in range(6)]
