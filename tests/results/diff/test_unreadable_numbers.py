"""Numbers that a typist could not read, marked by `?`, and those of YOUNG tables that are stars."""

import json
from xml.etree import ElementTree

import numpy as np
import pytest

from flexmb_cli.deck.fortran_words import split_fields, unit_of, value_of
from flexmb_cli.deck.listing import TableError
from flexmb_cli.dialects.dafms.listing_reader import parse_echo, parse_series
from flexmb_cli.dialects.vsdf.listing_reader import parse_vsdf
from flexmb_cli.dialects.young.listing_reader import parse_listing
from flexmb_cli.results.diff.listings import compare_listings
from flexmb_cli.results.diff.tolerances import Tolerances
from tests.results.diff.test_diff_folders import compared
from tests.results.diff.test_out_table_reader import BLOCK, faults, read, values
from tests.results.diff.test_vsdf_listing import TEXT

# Two lines of OUT-RSSR, YOUNG dissertation (1996), Appendix B: fields of eight characters that touch.
TOUCHING = "  1 -7.3304-1074.6427  0.0000-1861.1863  0.0000245.3407  1.0000  2.0000  3.0000"
POINT = "  1  1.0003  0.0000 -1.7319 -1.8133  0.0000 -1.0474 -1.0966  0.0000  1.8985"
ECHO = "ENTER NUMBER OF\n  1  1  0\nENTER VALUES OF CONSTRAINT\n  1.25-12.50  0.00\n"


def report(first, second, **tolerances):
    a, b = (parse_listing(name, text) for name, text in (("a", first), ("b", second)))
    return compare_listings(a, b, Tolerances(**tolerances))


@pytest.mark.parametrize("word", ["?", "??????", "1.000?", "?.0003", "-?", "1.0??3"])
def test_a_cell_with_a_question_mark_is_not_compared(word):
    typed = BLOCK.replace("1.0003", word)
    for pair in ((typed, BLOCK), (BLOCK, typed)):
        found = report(*pair)
        assert found.equal and found.unreadable == 1
        # 37 numbers and the time stand in the block.
        assert found.compared == 7 + 10 + 10 + 9 + 1 - 1
        assert found.text() == "a, b: no difference in 36 numbers; not compared: 1 marked ?\n"


def test_its_neighbours_are_compared():
    typed = BLOCK.replace("1.0003  0.0000 -1.7319", "1.000?  0.0000 -1.7318")
    found = report(typed, BLOCK)
    assert (found.differing, found.unreadable) == (1, 1)
    assert found.worst.column == "Z"
    assert found.text().endswith(
        "a, b: 1 of 36 numbers differ, 0 missing entries; not compared: 1 marked ?\n"
    )
    assert found.as_dict()["unreadable"] == 1
    assert found.as_dict()["kinds"]["point_position"]["unreadable"] == 1


def test_question_marks_in_fields_that_touch():
    """One digit of a number that touches its neighbours on both sides."""
    typed = BLOCK.replace(POINT, TOUCHING.replace("-1861.1863", "-18?1.1863"))
    found = read(typed).sections["point"]
    assert np.isnan(found.units[0]).tolist() == [False] * 3 + [True] + [False] * 5
    assert found.values[0][[1, 2, 4]].tolist() == [-1074.6427, 0.0, 0.0]
    assert report(typed, BLOCK.replace(POINT, TOUCHING)).equal


def test_a_row_before_or_behind_the_unreadable_one_is_not_touched():
    """Lines are read together where all are whole; a doubtful one must not change the others' digits."""
    rows = "".join(
        f"  {k}  1.0003  0.0000 -1.7319 -1.8133  0.0000 -1.0474 -1.0966  0.0000  1.8985\n" for k in (1, 2, 3)
    )
    whole = BLOCK.replace(POINT + "\n", rows)
    typed = BLOCK.replace(POINT + "\n", rows.replace("  1  1.0003", "  1  ?     ", 1))
    section = read(typed).sections["point"]
    assert section.units[1:].tolist() == 2 * [9 * [1e-4]]
    assert (report(typed, whole).unreadable, report(typed, whole).differing) == (1, 0)


def test_the_echo_of_the_input_may_hold_them():
    typed = ECHO.replace("-12.50", " -1?.5")
    found = report(typed, ECHO)
    assert (found.equal, found.compared, found.unreadable) == (True, 5, 1)
    assert report(ECHO, ECHO.replace("-12.50", " -1.50")).differing == 1


def test_same_attitude_is_judged_by_the_components_that_are_known():
    turned = "  1     0.000     0.000     0.000     0.600     0.000    -0.800     0.000"
    plain = "  1     0.000     0.000     0.000     1.000     0.000     0.000     0.000"
    typed = "  1     0.000     0.000     0.000         ?     0.000     0.800     0.000"
    a, b = (parse_listing("x", BLOCK.replace(plain, line)) for line in (typed, turned))
    assert compare_listings(a, b, Tolerances(), same_attitude=True).equal
    assert not compare_listings(a, b, Tolerances()).equal


@pytest.mark.parametrize(("old", "new"), [("TIME= 0.100", "TIME= 0.?00"), ("  1  1.0003", "  ?  1.0003")])
def test_a_time_or_a_number_of_a_body_must_be_readable(old, new):
    """They say which row it is."""
    typed = BLOCK.replace(old, new)
    if "TIME" in old:
        assert [line for line, _, _ in faults(BLOCK + typed)] == [26]
    else:
        assert report(BLOCK, typed).missing == ["point: 1 line of a is not in b: point 1 at t = 0.1"]


def test_stars_in_a_young_table_stand_for_a_number_that_does_not_fit():
    """Eight characters with four decimals hold -99.9999 to 999.9999, as OUT-RSSR overflows them."""
    stars = BLOCK.replace("  1.0003  0.0000", "********  0.0000")
    assert values(stars, "point")[0] == np.inf
    for large in ("-1000.0000", "12345.6789"):
        beyond = BLOCK.replace("  1.0003  0.0000", f"{large} 0.0000")
        assert report(stars, beyond).equal and report(beyond, stars).equal
    assert report(stars, BLOCK).differing == 1


def test_stars_that_touch_are_parted_by_the_width_of_their_fields():
    stars = BLOCK.replace("  1.0003  0.0000 -1.7319", 2 * "********" + " -1.7319")
    assert values(stars, "point")[:3] == [np.inf, np.inf, -1.7319]
    echo = ECHO.replace("-12.50", " ******")
    assert report(echo, ECHO.replace("-12.50", " 12345.67")).equal
    assert report(echo, ECHO).differing == 1


def test_a_line_of_thousands_of_stars_is_refused_at_once():
    found = faults(BLOCK.replace(POINT, "  1" + 20000 * "*" + "x"))
    assert len(found) == 1


def test_dafms_listings_and_series():
    """FMBD.OUT and fort.2 of DAFMS (Zhao, 1992): E15.6 fields and tags."""
    row = "   0.0000000-123.4567890   0.100000E+01\n   0.0100000   1.0000000   0.100000-101\n"
    a, b = parse_series("fort.2", row.replace("0.100000E+01", "0.1?0000E+01")), parse_series("fort.2", row)
    found = compare_listings(a, b, Tolerances())
    assert (found.equal, found.unreadable) == (True, 1)
    with pytest.raises(TableError):
        parse_series("fort.2", row.replace("   0.0100000", "   0.01?0000"))
    echo = "==N==NDM==    1    3\n     BM==    1 123.45000\n"
    a, b = parse_echo("a", echo.replace("123.45000", "12?.45000")), parse_echo("b", echo)
    found = compare_listings(a, b, Tolerances(), explain=True)
    assert (found.equal, found.unreadable, found.compared) == (True, 1, 3)


def test_vsdf_listings():
    row = next(line for line in TEXT.splitlines() if line.startswith("  ") and line.count("E") > 3)
    cell = row.split()[-1]
    typed = TEXT.replace(row, row[: -len(cell)] + "?".rjust(len(cell)), 1)
    found = compare_listings(parse_vsdf("a", typed), parse_vsdf("b", TEXT), Tolerances())
    assert (found.equal, found.unreadable) == (True, 1)
    with pytest.raises(TableError):
        parse_vsdf("a", TEXT.replace("TIME =  5.00000E-04", "TIME =  5.0000?E-04"))
    head = compare_listings(
        parse_vsdf("a", TEXT.replace("0.26 kg", "0.2? kg")), parse_vsdf("b", TEXT), Tolerances()
    )
    assert (head.equal, head.unreadable) == (True, 1)


def test_words_of_fields():
    assert np.isnan(value_of("1.2?")) and np.isnan(unit_of("1.2?"))
    assert split_fields("  ?  1", _edits(2)) == ["?", "1"]


def _edits(count):
    from flexmb_cli.deck.edit import I

    return count * (I(3),)


def test_the_command_counts_them_in_its_forms(tmp_path):
    for name, text in (("old", BLOCK.replace("1.0003", "?")), ("new", BLOCK)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "OUT-A").write_text(text)
    folders, page = (tmp_path / "old", tmp_path / "new"), tmp_path / "diff.xml"
    done = compared(*folders, "--junit", page)
    assert done.exit_code == 0
    assert "1 file compared, 0 differ, 0 missing, 1 number marked ? not compared" in done.stdout
    (case,) = ElementTree.parse(page).getroot().iter("testcase")
    assert "not compared: 1 marked ?" in case.find("system-out").text
    record = json.loads(compared(*(folder / "OUT-A" for folder in folders), "--json").stdout)
    assert (record["unreadable"], record["compared"], record["equal"]) == (1, 36, True)
