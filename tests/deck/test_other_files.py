"""Files that are no decks, named by their first bytes, and decks that begin like none."""

import gzip
import io
import zipfile
from pathlib import Path

import pytest

from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import recognise
from flexmb_cli.errors import DeckError

FOUR_BAR = (Path(__file__).resolve().parents[2] / "decks" / "young" / "IN4-BAR.dat").read_text()


def a_zip_archive():
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("deck", FOUR_BAR)
    return stream.getvalue()


@pytest.mark.parametrize(
    ("raw", "kind"),
    [
        (a_zip_archive(), "a zip archive or an office document"),
        (gzip.compress(FOUR_BAR.encode()), "compressed by gzip; unpack it"),
        (b"%PDF-1.7 4 0 obj", "a PDF document"),
    ],
)
def test_another_kind_of_file_is_named(raw, kind):
    with pytest.raises(DeckError, match=f"^this is not a deck but {kind}"):
        decode("IN.dat", raw)


def test_a_deck_in_full_width_characters_is_named_and_shown():
    wide = "".join(chr(ord(c) + 0xFEE0) if "!" <= c <= "~" else c.replace(" ", "\u3000") for c in FOUR_BAR)
    with pytest.raises(DeckError, match="full-width characters; type the deck in plain ASCII"):
        recognise(wide.splitlines())


def test_a_comment_without_end_is_named_before_the_dialect():
    with pytest.raises(DeckError, match="a comment is opened here and never closed with }"):
        recognise(["{ four bar", *(line.replace("}", "") for line in FOUR_BAR.splitlines())])


def test_a_page_of_text_is_no_printed_table_although_it_shows_one():
    page = Path(__file__).resolve().parents[2] / "README.md"
    with pytest.raises(DeckError, match="a page of text") as refused:
        recognise(page.read_text(encoding="utf-8").splitlines())
    assert "YOUNG run printed" not in str(refused.value)
