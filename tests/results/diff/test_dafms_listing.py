"""Reading the echo FMBD.OUT and the time series of DAFMS, ours and those of the historic program.

Layouts: DAFMS thesis (Zhao, 1992), appendix C; the sample echoes come from its READ and WRITE statements.
"""

import io
import re
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.deck.listing import TableError
from flexmb_cli.dialects.dafms.listing import Series
from flexmb_cli.dialects.dafms.listing_reader import parse_echo, parse_series

PUBLISHED = Path(__file__).parents[2] / "published" / "dafms"
TWO_LINK = (PUBLISHED / "two_link_n2.OUT").read_text()


def numbers(text, title):
    return [value for line in parse_echo("x", text).echo if line.title == title for value in line.values]


@pytest.mark.parametrize(
    ("title", "expected"),
    [
        ("counts", [2, 2]),
        ("rotations", [1, 1, 1, 0, 0, 2, 1, 1, 0, 0]),
        ("steps", [500]),
        ("step", [0.01]),
        ("COOR", [1, 1, 0, 0.5, 0, 1, 2, 0, 1, 0, 2, 1, 0, 0.5, 0, 2, 2, 0, 1, 0]),
        ("BKCP", 2 * [0.1097e6, -0.3429e5, 0.1371e5]),
        ("=BK=", 2 * [0.1097e6, -0.3429e5, -0.3429e5, 0.1371e5]),
        ("NP==", [1, 2, 2, 2]),
        ("EPT=", [1, 0, 0, 0, 1, 2, 0.04362, 0, 0, 0.99905]),
        ("X(L)", [0, 0.08727, 0, 0, 0, 0]),
    ],
)
def test_the_echo_is_read_by_its_tags(title, expected):
    assert numbers(TWO_LINK, title) == expected


@pytest.mark.parametrize("path", sorted(PUBLISHED.glob("*.OUT")), ids=lambda path: path.stem)
def test_every_line_of_the_echoes_is_read(path):
    """All lines but the headings, and of these lines everything after the tag."""
    listing = parse_echo(path.name, path.read_text())
    lines = [line for line in path.read_text().splitlines() if line and not line.startswith("DFMB")]
    assert len(listing.echo) == len(lines)
    for read, line in zip(listing.echo, lines, strict=True):
        tail = line.split()[-len(read.values) :]
        assert list(read.values) == [float(word) for word in tail]
    assert len(listing.words) == 2


@pytest.mark.parametrize(
    ("line", "title", "values"),
    [
        ("     RC==    11234.56789-123.45678****.*****".replace("****.*****", "**********"), "RC==",
         [1, 1234.56789, -123.45678, np.inf]),
        ("  JDIA    110000*****99999", "JDIA", [1, 10000, np.inf, 99999]),
        ("  JDIA    1 100000 123456", "JDIA", [1, 100000, 123456]),
        ("     RC==    1 1234567.80000   2.00000 -12345.67800", "RC==", [1, 1234567.8, 2, -12345.678]),
        ("  BMI=1234.567891234.567892345.67891", "BMI=", [1234.56789, 1234.56789, 2345.67891]),
        ("  BKCP -.5239E+06   .6457E-06", "BKCP", [-0.5239e6, 0.6457e-6]),
        ("  BKCP -0.5239-106  0.6457E+06", "BKCP", [-0.5239e-106, 0.6457e6]),
        ("     RC==    1      -0.     0.000  -0.00000", "RC==", [1, 0, 0, 0]),
    ],
)  # fmt: skip
def test_fields_that_touch_widen_or_are_stars_are_parted(line, title, values):
    text = TWO_LINK.partition("     RC==")[0] + line + "\n"
    assert numbers(text, title)[-len(values) :] == values


def test_lines_of_the_debugging_program_are_passed_over():
    noisy = TWO_LINK.replace("     LC==", "  ==WKD==  1.0000  2.0000\n\n     LC==")
    assert [line.values for line in parse_echo("x", noisy).echo] == [
        line.values for line in parse_echo("x", TWO_LINK).echo
    ]


def test_a_line_that_cannot_be_read_is_located():
    with pytest.raises(TableError) as caught:
        parse_echo("x", TWO_LINK.replace("  NEQ=    2", "  NEQ=    Z", 1))
    fault = caught.value.faults[0]
    assert (fault.place.line, fault.place.column) == (16, 11)
    assert fault.sentence == "NEQ=: 1 numbers are expected, read 'Z'"


@pytest.mark.parametrize("word", ["0.1E" + 5000 * "0", "0.1+" + 5000 * "9", 5000 * "1" + "x", "\u0130nf"])
def test_a_word_that_python_makes_no_number_of_is_located(word):
    """No integer of so many digits; trying where they part took minutes; a capital I with a dot."""
    with pytest.raises(TableError) as caught:
        parse_echo("x", re.sub(r"(BKCP\s+)\S.*", rf"\g<1>{word}", TWO_LINK, count=1))
    assert caught.value.faults[0].sentence == f"BKCP: numbers are expected, read {word!r}"


def test_other_texts_are_no_echo_and_no_series():
    for text in ("", "Dear Sir,\n", "1 2 3\n", "0.123456789 1.0\n", "-- KINEMATIC ANALYSIS --\n"):
        assert parse_echo("x", text) is None
        assert parse_series("x", text) is None


def series(q, y, layout="safe"):
    units = io.StringIO(), io.StringIO()
    Series(*units, len(q[0]), layout).rows(0.01 * np.arange(len(q)), np.array(q), np.array(y))
    return tuple(unit.getvalue() for unit in units)


STATE = np.random.default_rng(2).uniform(-1, 1, (5, 12)) * 10.0 ** np.arange(-6, 6)


@pytest.mark.parametrize("layout", ["safe", "historic"])
def test_series_come_back_with_their_columns(layout):
    unit2, unit3 = series(STATE[:, 6:], STATE[:, :6], layout)
    two, three = parse_series("x.T2", unit2), parse_series("fort.3", unit3)
    assert two.time.tolist() == [0, 0.01, 0.02, 0.03, 0.04]
    assert two.sections["series"].columns == ("last speed", "coordinate 1", "coordinate 2")
    assert three.sections["series"].columns == ("coordinate 3", "coordinate 5", "coordinate 6")
    for listing, wanted in ((two, STATE[:, [5, 6, 7]]), (three, STATE[:, [8, 10, 11]])):
        section = listing.sections["series"]
        assert np.all(np.abs(section.values - wanted) <= 0.500001 * section.units)
        assert section.units[:, 0].tolist() == 5 * [1e-7]


def test_series_with_stars_and_touching_fields_are_read():
    text = "   0.0000000-123.4567890   0.100000E+01\n   0.0100000************   0.100000-101\n"
    section = parse_series("x.T2", text).sections["series"]
    assert section.values.tolist() == [[-123.456789, 1.0], [np.inf, 0.1e-101]]


def test_the_note_of_a_stop_is_seen():
    unit2, unit3 = io.StringIO(), io.StringIO()
    writer = Series(unit2, unit3, 6)
    writer.rows(np.array([0.0]), STATE[:1, 6:], STATE[:1, :6])
    assert not parse_series("x.T3", unit3.getvalue()).failed
    writer.failed(1e-6, 1.0, 0.01, 0.5, STATE[0])
    listing = parse_series("x.T3", unit3.getvalue())
    assert listing.failed
    assert len(listing.time) == 1


def test_a_broken_line_of_a_series_is_located():
    with pytest.raises(TableError) as caught:
        parse_series("x.T2", series(STATE[:, 6:], STATE[:, :6])[0].replace("0.0200000", "0.02OOOOO"))
    assert caught.value.faults[0].place.line == 3


@pytest.mark.parametrize("spoilt", ["#  0.0200000", "   0.0200000 #", "   1_0.0200000"])
def test_a_line_that_is_no_row_of_numbers_is_not_passed_over(spoilt):
    """A comment of numpy's is none of FORTRAN's: its row was dropped."""
    text = series(STATE[:, 6:], STATE[:, :6])[0].replace("   0.0200000", spoilt)
    with pytest.raises(TableError) as caught:
        parse_series("x.T2", text)
    assert caught.value.faults[0].place.line == 3
