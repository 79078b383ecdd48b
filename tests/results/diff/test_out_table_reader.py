"""Reading OUT tables, ours and those of the YOUNG dissertation's Appendix B."""

import io

import numpy as np
import pytest

from flexmb_cli.deck.listing import TableError, plain_text
from flexmb_cli.dialects.young.listing import OutTable, report_block
from flexmb_cli.dialects.young.listing_reader import parse_listing

BLOCK = """
-----
TIME= 0.100
-----
POSITION
BODY       X         Y         Z         e0        e1        e2        e3
  1     0.000     0.000     0.000     1.000     0.000     0.000     0.000


VELOCITY
BODY  dX     dY     dZ     de0    de1    de2    de3    w-x    w-y    w-z
  1  0.000  0.000  0.000  0.000  0.000  0.000  0.000   0.00   0.00  0.000

ACCELERATION
BODY  ddX    ddY    ddZ    dde0   dde1   dde2   dde3   dw-x   dw-y   dw-z
  1  0.000  0.000  0.000  0.000  0.000  0.000  0.000  0.000  0.000  0.000


POINTS OF INTEREST
No   X       Y       Z       dX      dY      dZ      ddX     ddY     ddZ
  1  1.0003  0.0000 -1.7319 -1.8133  0.0000 -1.0474 -1.0966  0.0000  1.8985

*****
"""


def read(text, name="OUT"):
    return parse_listing(name, text if isinstance(text, str) else plain_text(text))


def faults(text):
    with pytest.raises(TableError) as caught:
        read(text)
    return [(fault.place.line, fault.place.column, fault.sentence) for fault in caught.value.faults]


def values(text, section, row=0):
    return read(text).sections[section].values[row].tolist()


def test_acceleration_fields_that_touch_are_parted():
    """OUT4-BAR, Appendix B: `24.430-36.634-56.813 10.489-100.734-71.565 76.328`."""
    old = "  1  0.000  0.000  0.000  0.000  0.000  0.000  0.000  0.000  0.000  0.000"
    new = "  1 24.430-36.634-56.813 10.489-100.734-71.565 76.328  0.000  0.000  0.000"
    read_values = values(BLOCK.replace(old, new), "acceleration")
    assert read_values[:7] == [24.430, -36.634, -56.813, 10.489, -100.734, -71.565, 76.328]


def test_point_fields_that_touch_are_parted_by_their_four_decimals():
    """OUT-RSSR, Appendix B: `0.0000-379.0828`, `0.0000245.3407`, `-7.3304-1074.6427  0.0000-1861.1863`."""
    head = "  1  1.0003  0.0000 -1.7319 -1.8133  0.0000"
    text = BLOCK.replace(f"{head} -1.0474 -1.0966  0.0000  1.8985", f"{head} -7.3304-1074.64270.0000245.3407")
    assert values(text, "point")[5:] == [-7.3304, -1074.6427, 0.0, 245.3407]


def test_a_value_that_touches_the_body_number_is_parted():
    text = BLOCK.replace(
        "  1     0.000     0.000     0.000     1.000", "  1-12345.678123456.789    0.000     1.000"
    )
    assert values(text, "position")[:4] == [-12345.678, 123456.789, 0.0, 1.0]


def test_the_oldest_listings_have_two_decimals_everywhere():
    """OUT1-4-3, Appendix B."""
    old = "  1  0.000  0.000  0.000  0.000  0.000  0.000  0.000   0.00   0.00  0.000"
    section = read(BLOCK.replace(old, "  1-10.00-20.00 0.25 0.00 0.00 0.52 0.00 0.00 1.05 0.00")).sections[
        "velocity"
    ]
    assert section.values[0].tolist() == [-10, -20, 0.25, 0, 0, 0.52, 0, 0, 1.05, 0]
    assert section.units[0].tolist() == 10 * [0.01]


@pytest.mark.parametrize("layout", ["safe", "historic"])
def test_what_is_written_comes_back(layout):
    """Numbers of five to seven figures fill and overfill the fields of both layouts."""
    random = np.random.default_rng(5)
    wanted = random.uniform(-1, 1, (40, 1 + 27 * 3 + 9 * 2)) * 10.0 ** random.integers(-4, 7, (40, 100))
    wanted[:, 0] = np.arange(40)
    listing = read(report_block(3, 2, layout).lines(wanted))
    assert listing.time.tolist() == list(range(40))
    start = 1
    for name, lines, width in (
        ("position", 3, 7),
        ("velocity", 3, 10),
        ("acceleration", 3, 10),
        ("point", 2, 9),
    ):
        section = listing.sections[name]
        expected = wanted[:, start : start + lines * width].reshape(-1, width)
        assert np.all(np.abs(section.values - expected) <= 0.5000001 * section.units)
        assert section.index.tolist() == 40 * list(range(1, lines + 1))
        assert section.step.tolist() == np.repeat(np.arange(40), lines).tolist()
        start += lines * width


def test_the_echo_is_read_line_by_line(deck):
    stream = io.StringIO()
    OutTable((stream,), deck).begin()
    echo = read(stream.getvalue()).echo
    assert echo[0].values == (2, 1, 1, 1, 0, 0, 0, 0, 0, 2, 0, 1)
    assert [line.values for line in echo if "LOCAL COORDINATES" in line.title] == [(0, 0, 0, -1, 0, 0)]
    assert echo[-2].values == (1, 1, 0, 1, 2, 0, 1, 3, 0, 1, 4, 0, 1, 5, 0, 1, 6, 0)
    assert echo[-1].values == (0, 6, 1)


def test_line_ends_and_spacing_of_titles_do_not_matter():
    plain = read(BLOCK)
    other = read(BLOCK.replace("BODY  dX     dY ", "BODY dX dY").replace("\n", "\r\n"))
    for name, section in plain.sections.items():
        assert np.array_equal(section.values, other.sections[name].values)


def test_a_title_with_fewer_columns_names_those_that_are_there():
    text = BLOCK.replace("dw-x   dw-y   dw-z", "").replace(30 * " " + "\n", "\n")
    text = text.replace("  1" + 10 * "  0.000", "  1" + 7 * "  0.000")
    assert read(text).sections["acceleration"].columns == (
        "ddX",
        "ddY",
        "ddZ",
        "dde0",
        "dde1",
        "dde2",
        "dde3",
    )


def test_the_mark_of_a_failed_run_is_seen():
    assert not read(BLOCK).failed
    assert read(BLOCK + "\n\n-----CONVERGENCE FAILED-----\n").failed
    assert read(BLOCK + "\n\n-----RUN STOPPED-----\n").failed


def test_text_that_is_no_table_is_told_from_one():
    assert read("Dear Sir,\n1 2 3\n") is None
    assert read(b"") is None
    assert read(bytes(range(256))) is None


def test_a_line_with_too_few_numbers_is_located():
    text = BLOCK.replace("  1     0.000     0.000     0.000     1.000", "  1     0.000     0.000     1.000")
    assert faults(text) == [(7, 9, "position of body 1: 7 numbers are expected (X … e3), 6 are there")]


@pytest.mark.parametrize("word, remedy", [
    ("-1.8l33", "letter l instead of one?"),
    ("-1.8133e", "digits of the exponent are missing"),
    ("\u0130nf", "write plain ASCII characters, not full-width or typographic ones"),
])  # fmt: skip
def test_a_word_among_the_numbers_is_located(word, remedy):
    text = BLOCK.replace("-1.7319 -1.8133", f"-1.7319 {word}")
    wrong = f"point of point 1: 9 numbers are expected (X … ddZ), '{word}' is not a number of this table"
    assert faults(text) == [(21, 29, f"{wrong}: {remedy}")]


def test_all_bad_lines_are_told_in_their_order():
    text = (
        BLOCK.replace("1.0003", "1.0O03")
        .replace("TIME= 0.100", "TIME= soon\n\nTIME= 0.1")
        .replace(" 1.000 ", " 1.00O ")
    )
    assert [line for line, _, _ in faults(text)] == [3, 9, 23]


def test_a_line_without_a_body_number_is_located():
    text = BLOCK.replace(
        "  1     0.000     0.000     0.000     1.000", "  0     0.000     0.000     0.000     1.000"
    )
    assert faults(text) == [(7, 1, "position: a number of a body is expected first, read '0'")]
