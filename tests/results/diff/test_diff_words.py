"""Words of results: `diff` reports where they differ, and counts them with `--words`."""

import json
from pathlib import Path

import h5py
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.diff import diff
from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.young.listing import echo_of_input
from tests.results.results import write_result

REPOSITORY = Path(__file__).resolve().parents[3]
PUBLISHED = REPOSITORY / "tests/published/dafms/two_link_n2.OUT"
TABLE = """FOR BODY 1 ENTER INITIAL ESTIMATES OF X,Y,Z & E0 E1,E2,E3
  0.00  0.00  0.00  1.00  0.00  0.00  0.00
ENTER BODY No FOR No 1 GROUNDED BODY
1
ENTER BODY 1 COORDINATES
 1 1  0.00 1 2  0.00 1 3  0.00 1 4  0.00 1 5  0.00 1 6  0.00
-- KINEMATIC ANALYSIS --
TIME= 0.000
POSITION
BODY       X         Y         Z         e0        e1        e2        e3
  1     0.000     0.000     0.000     1.000     0.000     0.000     0.000
TIME= 1.000
POSITION
BODY       X         Y         Z         e0        e1        e2        e3
  1     0.000     0.000     0.000     1.000     0.000     0.000     0.000
"""


def compared(folder, a, b, *options):
    """Exit code of `diff` for two texts, and what it prints."""
    for name, text in (("a", a), ("b", b)):
        (folder / name).write_text(text)
    done = CliRunner().invoke(diff, [str(folder / "a"), str(folder / "b"), *options])
    return done.exit_code, done.output


@pytest.mark.parametrize(("deck", "body"), [("IN4-BAR", 4), ("IN5BODY", 5), ("IN2-1-1", 1)])
def test_the_echo_of_a_grounded_body_shows_its_number(deck, body):
    """Appendix B of Liang Yong's dissertation: nine listings print the number (OUT4-BAR: body 4)."""
    source = read_text(REPOSITORY / f"decks/young/{deck}.dat")
    assert f"\nENTER BODY {body} COORDINATES\n" in echo_of_input(read_deck(source))


def test_words_are_reported_and_count_when_asked(tmp_path):
    other = TABLE.replace("BODY 1 COORD", "BODY B COORD")
    code, text = compared(tmp_path, TABLE, other)
    assert code == 0
    assert "words: line 5: 'ENTER BODY 1 COORDINATES' against 'ENTER BODY B COORDINATES'\n" in text
    assert text.endswith("no difference in 42 numbers; 1 line of words differs\n")
    assert compared(tmp_path, TABLE, other, "--words")[0] == 1
    assert compared(tmp_path, TABLE, TABLE, "--words")[0] == 0


def test_a_line_that_one_file_lacks_is_told_with_its_own_place_only(tmp_path):
    other = TABLE.replace("-- KINEMATIC ANALYSIS --\n", "")
    code, text = compared(tmp_path, TABLE, other)
    assert code == 0
    assert f"words: line 7: '-- KINEMATIC ANALYSIS --' is only in {tmp_path}/a\n" in text
    assert text.count("words:") == 1


def test_a_title_of_the_blocks_is_told_once_and_spacing_does_not_count(tmp_path):
    other = TABLE.replace("POSITION\n", "PLACES  OF BODIES\n").replace("ENTER BODY", "ENTER  BODY")
    sections = "words: line 9: 'POSITION' against 'PLACES OF BODIES'\n"
    assert compared(tmp_path, TABLE, other)[1].count(sections) == 1


def test_the_status_counts_without_being_asked(tmp_path):
    assert compared(tmp_path, TABLE, TABLE + "-----RUN STOPPED-----\n")[0] == 1


def test_the_heading_of_a_dafms_echo_is_words(tmp_path):
    text = PUBLISHED.read_text()
    other = text.replace("DFMB FLEXIBLE", "DFMB RIGID")
    assert [compared(tmp_path, text, other, *options)[0] for options in ((), ("--words",))] == [0, 1]
    code, printed = compared(tmp_path, text, other, "--words", "--json")
    assert (code, len(json.loads(printed)["words"])) == (1, 2)
    assert compared(tmp_path, text, other, "--words", "--tol", "echo=inf")[0] == 0


def test_the_cards_of_a_vsdf_listing_are_words_and_numbers(tmp_path):
    head = 20 * "*" + "\nVSDF A ROD\nRIGD 1 2.5\n" + 20 * "*" + "\n BODY NODE X\n TIME =  0.00000E+00\n"
    code, text = compared(tmp_path, head, head.replace("A ROD", "A BAR"))
    assert code == 0
    assert "words: line 2: 'VSDF A ROD' against 'VSDF A BAR'\n" in text
    code, text = compared(tmp_path, head, head.replace("2.5", "2.6"))
    assert (code, "words" in text) == (1, False)


@pytest.mark.parametrize("name", ["notes", "settings"])
def test_notes_and_settings_of_results_are_words(tmp_path, name):
    a, b = (write_result(tmp_path / f"{letter}.h5", 3) for letter in "ab")
    with h5py.File(b, "a") as file:
        file.attrs[name] = "driver.1.B=3"
    done = CliRunner().invoke(diff, [str(a), str(b)])
    assert done.exit_code == 0
    assert f"words: {name}: '' against 'driver.1.B=3'\n" in done.output
    assert CliRunner().invoke(diff, [str(a), str(b), "--words"]).exit_code == 1


def test_a_page_heading_within_a_section_hides_no_numbers(tmp_path):
    """Appendix B has `IN-4-BAR & OUT-4-BAR` at the head of a page, between rows of a section."""
    row = "  1     0.000     0.000     0.000     1.000     0.000     0.000     0.000\n"
    table = TABLE.replace(row, row + row.replace("  1 ", "  2 "))
    headed = table.replace(row, row + "IN-4-BAR & OUT-4-BAR\n", 1)
    code, reported = compared(tmp_path, headed, table)
    assert (code, "missing entries" in reported) == (0, False)
    wrong = table.replace("  2     0.000", "  2     0.500", 1)
    assert compared(tmp_path, headed, wrong)[0] == 1


def test_rows_under_an_unknown_heading_go_to_no_other_section(tmp_path):
    first, other = TABLE.split("TIME= 1.000\n")
    titles = "BODY       X         Y         Z         e0        e1        e2        e3\n"
    row = "  1     9.000     0.000     0.000     1.000     0.000     0.000     0.000\n"
    code, reported = compared(tmp_path, f"{first}PLACES\n{titles}{row}TIME= 1.000\n{other}", TABLE)
    assert (code, "9.000" in reported) == (0, False)
