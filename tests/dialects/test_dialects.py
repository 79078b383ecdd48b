"""Which dialect a deck is in."""

import subprocess
import sys
from pathlib import Path

import pytest

from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import read_deck, recognise
from flexmb_cli.errors import DeckError, Place
from tests.dialects.young.young_decks import PENDULUM, pendulum

DECKS = Path(__file__).parents[2] / "decks"


@pytest.mark.parametrize(
    "path", sorted([*DECKS.glob("young/*.dat"), *DECKS.glob("dafms/*.DAT")]), ids=lambda path: path.name
)
def test_supplied_decks_are_recognised_by_their_beginning(path):
    assert recognise(path.read_text(encoding="utf-8").split("\n")) == path.parent.name


@pytest.mark.parametrize("text", ["VSDF A PLATE", "\n  vsdf\nBODY"])
def test_the_word_vsdf_begins_a_vsdf_deck(text):
    assert recognise(text.split("\n")) == "vsdf"


def test_a_young_deck_with_a_slip_in_its_counts_is_still_a_young_deck():
    assert recognise(pendulum(1, "2 1 0 O 0 1 0 0 0 0 0 1").split("\n")) == "young"


BEGINNINGS = (
    "a VSDF deck begins with the word VSDF, "
    "a DAFMS deck begins with two integers, then a card DFMB, STAR or STOP, "
    "a YOUNG deck begins with twelve integers"
)


def refused(text, dialect="auto"):
    with pytest.raises(DeckError) as error:
        read_deck(decode("x", text), dialect)
    (fault,) = error.value.faults
    return fault.message, fault.place


def test_when_none_fits_the_message_says_what_each_begins_with():
    message, place = refused(b"\n  Dear reader,\n")
    assert message == f"no dialect begins like this; {BEGINNINGS}; --dialect chooses one"
    assert place == Place(2, 3, 4)


def test_an_empty_deck_is_of_no_dialect():
    assert refused(b" \n") == (f"the deck is empty; {BEGINNINGS}", None)


def test_an_unknown_dialect_is_refused_with_those_that_exist():
    assert refused(b"", "fortran") == ("there is no dialect 'fortran', only vsdf, dafms, young", None)


def test_doubts_about_the_text_stand_before_those_of_the_reader():
    text = PENDULUM.replace("0 6 1", "{ \xb5 } 0 6 1").replace("1 2 0", "1 2.0 0").encode("latin-1")
    severities = [fault.message[:24] for fault in read_deck(decode("x", text)).warnings]
    assert severities == ["the deck is not UTF-8 an", "J should be an integer; "]


def test_reading_and_building_a_young_deck_import_no_numerical_library():
    program = (
        "import sys; from flexmb_cli.deck.text import read_text; "
        "from flexmb_cli.dialects.recognise import read_deck; "
        "from flexmb_cli.dialects.young.build import build_young; import flexmb_cli.cli.check; "
        "import flexmb_cli.dialects.settings; build_young(read_deck(read_text(sys.argv[1]))); "
        "print(sorted({'numpy', 'scipy', 'numba', 'h5py'} & set(sys.modules)))"
    )
    deck = str(DECKS / "young" / "IN4-BAR.dat")
    done = subprocess.run([sys.executable, "-c", program, deck], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_dafms_deck_with_a_slip_of_sign_in_its_counts_is_still_a_dafms_deck():
    text = (DECKS / "dafms" / "pendulum.DAT").read_text()
    assert recognise(text.splitlines()) == "dafms"
    first, rest = text.split("\n", 1)
    assert recognise([f"{first[:-2]}-1", *rest.splitlines()]) == "dafms"
