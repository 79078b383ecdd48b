"""Reading and comparing the listing of a VSDF deck; the numbers of the sample are made up, each its own."""

import io
import re
from types import SimpleNamespace

import numpy as np
import pytest

from flexmb_cli.deck.listing import TableError
from flexmb_cli.deck.record import Deck, DeckText
from flexmb_cli.dialects.vsdf.listing import VsdfTable
from flexmb_cli.dialects.vsdf.listing_reader import parse_vsdf
from flexmb_cli.results.diff.listings import compare_listings
from flexmb_cli.results.diff.tolerances import KINDS, Tolerance, Tolerances

RULE = "*" * 78
HEAD = f"""{RULE}
VSDF PENDULUM OF 16 BRICKS
BODY
    1 FLEX    9    1   13    9
TIME
       0.5    5.0E-4    5.0E-5
OUTN
    1   51
STOP
{RULE}
  body 1: nodes 54, modes 2, mass 0.26 kg
    centre of mass 0.05 0.005 0.0075 m
    mode         rad/s            Hz  share of effective mass, %: x, y, z, about x, about y, about z
       1     33.079431      5.264755    0.05  49.17   4.09  38.33   6.60  85.27
  constraint equations 5, independent 5, speeds 15
  degrees of freedom 10, smallest singular value 7.359E-02

      BODY    NODE            X            Y            Z           VX           VY           VZ
             KINETIC       STRAIN      GRAVITY          SUM   (J; gravity with springs)

"""
ROWS = """ TIME =  0.00000E+00
         1      51  1.00000E-01  0.00000E+00  1.50000E-02  0.00000E+00  0.00000E+00  0.00000E+00
         2       7  3.00000E-01  1.25000E-02 -1.50000E-02  2.00000E+00  4.00000E+00  5.00000E+00
 ENERGY  0.00000E+00  1.00000E-03 -2.00000E-02 -1.90000E-02
 TIME =  5.00000E-04
         1      51  1.10000E-01 -6.25000E-03  2.50000E-02 -7.50000E-01  8.50000E+01  9.50000E-03
         2       7  3.10000E-01  2.25000E-02 -2.50000E-02  2.10000E+00  4.10000E+00  5.10000E+00
 ENERGY  7.00000E-03  1.10000E-03 -2.10000E-02 -1.29000E-02
"""
TEXT = HEAD + ROWS
FAILED = " THE RUN ENDED BEFORE THE LAST TIME\n"


def report_of(a, b, tolerances=None):
    return compare_listings(parse_vsdf("a", a), parse_vsdf("b", b), tolerances or Tolerances())


def differing(report):
    return {kind: tally.differing for kind, tally in report.tallies.items() if tally.differing}


def test_rows_are_read_by_time_and_node():
    listing = parse_vsdf("x", TEXT)
    assert listing.time.tolist() == [0.0, 5e-4]
    node, energy = listing.sections["node"], listing.sections["energy"]
    assert node.values[2].tolist() == [0.11, -0.00625, 0.025, -0.75, 85.0, 0.0095]
    assert np.allclose(node.units[2], [1e-6, 1e-8, 1e-7, 1e-6, 1e-4, 1e-8], rtol=1e-12)
    assert [node.name_of(line) for line in (2, 3)] == ["body 1 node 51", "body 2 node 7"]
    assert node.step.tolist() == [0, 0, 1, 1]
    assert energy.values[1].tolist() == [0.007, 0.0011, -0.021, -0.0129]
    assert not listing.failed
    assert parse_vsdf("x", TEXT + FAILED).failed


def test_fields_that_touch_are_parted_by_their_columns():
    text = TEXT.replace("  1.10000E-01 -6.25000E-03", " -1.10000E-01-6.25000E-103", 1)
    assert parse_vsdf("x", text).sections["node"].values[2][:2].tolist() == [-0.11, -6.25e-103]


NUMBER = re.compile(r"(?<!\S)-?\d+(\.\d+)?(E[-+]\d\d)?(?![\w.])")


def plants():
    """(line, column, text) with one digit changed: the last of a number, before its exponent."""
    lines = TEXT.splitlines()
    for n, line in enumerate(lines):
        for match in NUMBER.finditer(line):
            at = match.start() + len(match[0].partition("E")[0]) - 1
            digit = "8" if line[at] == "9" else str(int(line[at]) + 1)
            yield n, at, "\n".join([*lines[:n], line[:at] + digit + line[at + 1 :], *lines[n + 1 :]])


def test_one_digit_changed_in_any_number_is_found():
    kinds = set()
    for line, column, text in plants():
        report = report_of(TEXT, text)
        if line > HEAD.count("\n") and column < 18 and TEXT.splitlines()[line][:8].isspace():
            # The number of a body or node: now it is the line of another one.
            assert (len(report.missing), report.differing) == (2, 0)
            continue
        assert (report.missing, sum(differing(report).values())) == ([], 1)
        kinds |= differing(report).keys()
    assert kinds == {"time", "echo", "modal", "point_position", "point_velocity", "energy"}
    assert kinds <= set(KINDS)


def test_signs_of_zero_spacing_and_line_ends_are_no_difference():
    minus = TEXT.replace(" 0.00000E+00", "-0.00000E+00")
    wide = re.sub(r"  (?=[-\d.]+E)", "     ", TEXT)
    assert minus != TEXT != wide
    for other in (minus, wide, TEXT.replace("\n", "  \n")):
        report = report_of(TEXT, other)
        assert report.equal
        assert report.compared == report_of(TEXT, TEXT).compared


def test_the_worst_place_names_body_and_node():
    report = report_of(TEXT, TEXT.replace("8.50000E+01", "8.60000E+01"))
    assert report.worst.sentence == "node, body 1 node 51, VY at t = 0.0005: 85.0 against 86.0"


def test_kinds_can_be_left_out():
    other = TEXT.replace("33.079431", "33.079432").replace("16 BRICKS", "17 BRICKS")
    assert differing(report_of(TEXT, other)) == {"echo": 1, "modal": 1}
    kinds = {kind: Tolerance(np.inf) for kind in ("echo", "modal")}
    assert report_of(TEXT, other, Tolerances(kinds=kinds)).equal


def test_missing_rows_nodes_and_the_end_of_a_failed_run_are_told():
    shorter = HEAD + ROWS.partition(" TIME =  5.0")[0] + FAILED
    assert report_of(TEXT, shorter).missing == [
        "1 row of a is not in b: t = 0.0005",
        "only b ends with THE RUN ENDED BEFORE THE LAST TIME",
    ]
    lines = TEXT.splitlines(keepends=True)
    report = report_of(TEXT, "".join(line for line in lines if not line.startswith("         2       7")))
    assert report.missing == [
        "node: 2 lines of a are not in b: body 2 node 7 at t = 0, body 2 node 7 at t = 0.0005"
    ]


def test_a_line_that_cannot_be_read_is_located():
    with pytest.raises(TableError) as caught:
        parse_vsdf("x", TEXT.replace("8.50000E+01", "8.5OOOOE+01"))
    fault = caught.value.faults[0]
    assert fault.place.line == TEXT[: TEXT.index("8.50000E+01")].count("\n") + 1
    assert fault.message.startswith("8 numbers are expected, read '1      51")


@pytest.mark.parametrize(
    ("number", "damaged"),
    [(" 51  1.1", f" {5000 * '5'}  1.1"), (" 51  1.1", " **  1.1"), ("8.50000E+01", f"8.5E{5000 * '0'}")],
    ids=["node of 5000 digits", "node of stars", "exponent of 5000 digits"],
)
def test_what_is_no_number_of_a_node_or_too_long_for_one_is_located(number, damaged):
    with pytest.raises(TableError) as caught:
        parse_vsdf("x", TEXT.replace(number, damaged))
    assert caught.value.faults[0].place.line == TEXT[: TEXT.index(number)].count("\n") + 1


def test_an_exponent_of_thousands_of_digits_in_the_head_is_told():
    report = report_of(TEXT, TEXT.replace("5.0E-5", f"5.0E-{5000 * '0'}5"))
    assert report.missing == ["echo of the input: 11 numbers in a, 12 in b"]


def test_other_texts_are_no_listing():
    for text in ("", RULE, "VSDF\n", "Dear Sir,\n", f"{RULE}\nDear Sir,\n"):
        assert parse_vsdf("x", text) is None


@pytest.mark.parametrize("layout", ["safe", "historic"])
def test_what_is_written_comes_back(layout):
    """Numbers of all sizes, in the fields of the writer."""
    random = np.random.default_rng(8)
    shape = (5, 2, 3)
    position = random.normal(size=shape) * 10.0 ** random.integers(-120, 120, shape)
    velocity = random.normal(size=shape) * 10.0 ** random.integers(-9, 9, shape)
    energies = random.normal(size=(3, 5))
    outputs = [
        SimpleNamespace(body=k, name=name) for k, name in enumerate(("body 1 node 51", "body 2 node 7"))
    ]
    mechanism = SimpleNamespace(bodies=(), outputs=outputs)
    values = {"time": np.arange(5) * 5e-4, "point/position": position, "point/velocity": velocity}
    names = ("kinetic", "strain", "potential")
    values |= {f"energy/{name}": energy for name, energy in zip(names, energies, strict=True)}
    found = SimpleNamespace(equations=5, coordinates=15, rank=5, smallest=0.07359)
    stream = io.StringIO()
    deck = Deck("vsdf", DeckText("x.vsdf", HEAD.partition("\n")[2].partition(RULE)[0], ""), ())
    table = VsdfTable((stream,), deck, layout, SimpleNamespace(mechanism=mechanism, mobility=found))
    table.begin()
    table.rows(values)
    table.failed()
    listing = parse_vsdf("x", stream.getvalue())
    node, energy = listing.sections["node"], listing.sections["energy"]
    wanted = np.concatenate([position, velocity], axis=2).reshape(10, 6)
    assert np.all(np.abs(node.values - wanted) <= 0.500001 * node.units)
    assert np.all(np.abs(energy.values[:, :3] - energies.T) <= 0.500001 * energy.units[:, :3])
    assert [node.name_of(line) for line in (0, 1)] == ["body 1 node 51", "body 2 node 7"]
    assert node.step.tolist() == [0, 0, 1, 1, 2, 2, 3, 3, 4, 4]
    assert listing.failed
