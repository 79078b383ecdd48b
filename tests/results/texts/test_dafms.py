"""FMBD.OUT and the series of units 2 and 3 against echoes made with the listing's own statements.

The sample echoes come from the READ and WRITE statements of the DAFMS thesis (Zhao, 1992), appendix C.  The
deck of shaft_beam_n10 has a GRAV card, which the 1992 program did not know: its PIP= lines show no weight.
"""

import io
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.deck.edit import HISTORIC
from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.dafms.listing import Series, echo_text
from flexmb_cli.dialects.dafms.reader import read_dafms

TOP = Path(__file__).parents[3]
SAMPLES = sorted((TOP / "tests" / "published" / "dafms").glob("*.OUT"))


def deck(name, *changes):
    text = (TOP / "decks" / "dafms" / f"{name}.DAT").read_text()
    for old, new in changes:
        text = text.replace(old, new, 1)
    return read_dafms(DeckText(name, text, ""))


@pytest.mark.parametrize("layout", ["safe", "historic"])
@pytest.mark.parametrize("sample", SAMPLES, ids=[path.stem for path in SAMPLES])
def test_echoes_are_those_of_the_listing_byte_for_byte(sample, layout):
    assert echo_text(deck(sample.stem), layout) == sample.read_text()


def test_nodal_forces_are_echoed_with_the_weight_in_effect():
    """0.2 kg; the thesis (Zhao, 1992), DFIN, adds 9.8 m/s^2 along axis 2 where no card gives gravity."""
    card = "GRAV\n    0       1.0       2.0       3.0\nEND \n"
    lines = [
        line for line in echo_text(deck("pendulum_strict", ("END \n", card))).splitlines() if "PIP=" in line
    ]
    assert lines == ["  PIP=    1    1   0.20000   0.40000   0.60000"]
    (plain,) = [line for line in echo_text(deck("pendulum_strict")).splitlines() if "PIP=" in line]
    assert plain.endswith("0.00000   1.96000   0.00000")


def test_four_echoes_are_supplied():
    assert len(SAMPLES) == 4


def test_every_card_of_the_table_is_echoed():
    """Lines by the FORMATs of TSYSIN, with a value of its own in every field."""
    cards = (
        "FORC\n    1       1.5      -2.5       3.5\n    2        .5       .25      .125\n"
        "TOQU\n    1       4.5       5.5       6.5\n    2       7.5       8.5       9.5\n"
        "DESN\n    1    1       2.0       .05\n    2    0       0.0       0.0\n"
    )
    text = echo_text(deck("sliding_mass", ("END \n", cards + "END \n")))
    assert text.endswith(
        "     HF==    1   1.50000  -2.50000   3.50000\n"
        "     HF==    2   0.50000   0.25000   0.12500\n"
        "     HM==    1   4.50000   5.50000   6.50000\n"
        "     HM==    2   7.50000   8.50000   9.50000\n"
        "     IDS    1    1   2.00000   0.05000\n"
        "     IDS    2    0   0.00000   0.00000\n"
    )


def test_nopr_silences_the_cards_behind_it_until_prin():
    text = echo_text(deck("sliding_mass", ("MASS\n", "NOPR\nMASS\n"), ("XI  \n", "PRIN\nXI  \n")))
    assert "BM==" not in text
    assert "BII=" not in text
    assert "     XI==    1" in text


def test_cards_are_echoed_in_the_order_of_the_deck():
    mass = "MASS\n    1       1.0\n    2        .5\n"
    text = echo_text(deck("sliding_mass", (mass, ""), ("END \n", mass + "END \n")))
    assert text.index("RC==") < text.index("BM==")


def test_extension_cards_are_not_echoed():
    plain, extended = deck("two_link_n2"), deck("two_link_n2", ("END \n", "UNCO\nMETH\n    2\nEND \n"))
    assert echo_text(plain) == echo_text(extended)


def test_a_list_of_more_than_ten_bodies_repeats_its_title():
    many = "   11    2\nDFMB\n" + "".join(f"{k:5d}    0    0    0    0\n" for k in range(1, 12))
    many += "".join(f"{k:5d}    1    1    0    0\n" for k in range(1, 12)) + 2 * (
        50 * " " + "\n" + 5 * " " + "\n"
    )
    many += "   10\n       .01\nEND \nSTAR\nSTOP\n"
    lines = echo_text(read_dafms(DeckText("x", many, ""))).splitlines()
    assert lines[24] == "     NUMBER OF NODES IN BODY K    =" + 10 * "    0"
    assert lines[25] == "     NUMBER OF NODES IN BODY K    =    0"


def series(coordinates, time, q, y, layout="safe"):
    units = io.StringIO(), io.StringIO()
    Series(*units, coordinates, layout).rows(np.array(time), np.array(q), np.array(y))
    return tuple(unit.getvalue() for unit in units)


def test_units_2_and_3_hold_the_entries_the_listing_writes():
    """Y(NS), Y(NS+1), Y(NS+2) and Y(NS+3), Y(NS+5), Y(NS+6) under FORMAT(2F12.7,5E15.6), NS = 6."""
    q = [[0.11, -0.12, 0.13, -0.14, 1.5e-5, 0.16]]
    y = [[1.0, 2.0, 3.0, 4.0, 5.0, -6.25]]
    unit2, unit3 = series(6, [0.01], q, y)
    assert unit2 == "   0.0100000  -6.2500000   0.110000E+00  -0.120000E+00\n"
    assert unit3 == "   0.0100000   0.1300000   0.150000E-04   0.160000E+00\n"


def test_entries_a_small_model_lacks_are_left_out():
    unit2, unit3 = series(1, [0.0, 0.5], [[0.25], [0.5]], [[1.0], [2.0]])
    assert unit2 == "   0.0000000   1.0000000   0.250000E+00\n   0.5000000   2.0000000   0.500000E+00\n"
    assert unit3 == "   0.0000000\n   0.5000000\n"


def test_zero_has_no_sign_unless_the_old_look_is_wanted():
    q, y = [[-0.0, -1e-9]], [[0.0, -1e-9]]
    assert series(2, [0.0], q, y)[0] == "   0.0000000   0.0000000   0.000000E+00  -0.100000E-08\n"
    assert "  -0.0000000" in series(2, [0.0], q, y, HISTORIC)[0]


def test_a_stop_is_noted_on_unit_3():
    unit2, unit3 = io.StringIO(), io.StringIO()
    Series(unit2, unit3, 4).failed(1e-5, 0.5, 0.01, 0.25, np.arange(8.0))
    assert unit3.getvalue() == (
        "  TOL,XEND,H,,METH,MITER,INDEX   0.00001   0.50000   0.01000   0.25000\n"
        "  **Y**   0.00000   1.00000   2.00000   3.00000   4.00000   5.00000   6.00000\n"
        "  **Y**   7.00000\n"
    )
    assert unit2.getvalue() == ""
