"""Every message has a stable identifier of its own, and the page of messages lists them all."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "docs" / "_ext"))
import fault_calls  # noqa: E402
import fault_messages  # noqa: E402
import fault_words  # noqa: E402
from fault_calls import FORM  # noqa: E402

# Calls that pass on what another fault says, or many sentences of one kind.
CARRIERS = ("errors.py", "diagnostics.py", "quantities.py", "cluster.py")


def test_every_fault_has_an_identifier():
    without = [
        f'{site.path.relative_to(TOP)}:{site.line}: give it id="{fault_messages.proposal(site.path)}", '
        "or a later one"
        for site in fault_calls.sites()
        if fault_calls.identifier(site) is None and site.path.name not in CARRIERS
    ]
    assert not without


def test_the_identifier_proposed_is_free_and_of_the_area_of_its_neighbours():
    """YOUNG-105 to YOUNG-129 are retired, and no fault was ever given VSDF-000."""
    folder = fault_calls.PACKAGE / "dialects"
    for name, area in (
        ("vsdf/bodies.py", "VSDF"),
        ("young/new_file.py", "YOUNG"),
        ("dafms/hinges.py", "DAFMS"),
    ):
        found = fault_messages.proposal(folder / name)
        assert FORM.fullmatch(found) and found.startswith(f"{area}-")
        assert found not in _given() and found not in fault_messages.RETIRED


def _given() -> set[str]:
    return set(fault_messages.messages())


def test_no_two_messages_share_an_identifier():
    """Calls that make a fault of one meaning may share it: their words are the same."""
    shared = {name: texts for name, texts in fault_messages.messages().items() if len(texts) > 1}
    assert not shared
    assert all(map(FORM.fullmatch, _given()))


def test_a_function_that_hands_identifiers_on_gives_none_by_itself():
    """Such a function would have one identifier for whatever its callers say."""
    catch_all = [
        f"{site.path.relative_to(TOP)}:{site.line}: let the callers give the id"
        for site in fault_calls.sites()
        if fault_calls.identifier(site) and fault_words.says_what_callers_say(site)
    ]
    assert not catch_all


def test_the_page_of_messages_is_that_of_the_program():
    """An identifier that is gone, is new, or has other words needs the page written anew."""
    assert fault_messages.PAGE.read_text(encoding="utf-8") == fault_messages.page(), (
        "run `python docs/_ext/fault_messages.py`"
    )


def test_every_row_of_the_page_shows_words():
    """CSV tables and cases of a study report what happened there, after a few letters of their own."""
    rows = re.findall(r"^\| ([A-Z]+-\d+) \| (.*) \|$", fault_messages.page(), re.MULTILINE)
    silent = [name for name, text in rows if name in _given() and sum(map(str.isalpha, text)) < 4]
    assert len(rows) > 800 and not silent


def test_an_identifier_of_the_page_is_not_lost_when_it_is_written_anew(tmp_path):
    page = tmp_path / "messages.md"
    page.write_text("| VSDF-999 | a message of an earlier version |\n", encoding="utf-8")
    with pytest.raises(SystemExit, match=r"RETIRED.*VSDF-999"):
        fault_messages.write(page)
    assert "VSDF-999" in page.read_text(encoding="utf-8")


def test_the_identifier_of_a_fault_that_is_gone_is_not_given_to_another():
    """Scripts rely on these: an identifier may go, but its number is not given to another fault."""
    given = _given()
    successors = {found[0] for found in FORM.finditer(" ".join(fault_messages.RETIRED.values()))}
    assert len(given) > 800
    assert not given & set(fault_messages.RETIRED)
    assert successors <= given


def test_the_faults_of_elements_that_moved_out_of_young_are_retired():
    """YOUNG-105 to YOUNG-129 were the faults of functions and elements before all dialects had them."""
    kept = {"YOUNG-121", "YOUNG-122", "YOUNG-123"}
    moved = {f"YOUNG-{number}" for number in range(105, 130)} - kept
    assert kept <= _given()
    assert all(fault_messages.RETIRED[name].startswith("ELEMENTS-") for name in moved)


def test_a_message_is_read_from_the_assignment_before_its_fault():
    """A check of a law's numbers assigns the message before it reports it."""
    page = fault_messages.page()
    assert "| ELEMENTS-039 | … must be larger than …; read … |" in page
    assert "| ELEMENTS-011 | a joint that turns needs the radius of its bearing |" in page


def test_a_message_is_followed_through_the_function_that_hands_it_on():
    """`line_fault` puts the place in front, `_report` of a card its FORMAT after."""
    page = fault_messages.page()
    assert "| FE-111 | …, line …: the matrix must be square; it has … rows, … columns |" in page
    assert "is not read; FORMAT(…) |" in page


@pytest.mark.processes
def test_json_records_carry_the_identifiers(tmp_path):
    """The misplaced body number of the README."""
    text = (TOP / "decks/young/IN4-BAR.dat").read_text().replace("1 2 0 0 2 0 6.10", "1 9 0 0 2 0 6.10")
    command = [sys.executable, "-m", "flexmb_cli", "check", "--json", "-"]
    done = subprocess.run(command, input=text, capture_output=True, text=True, cwd=tmp_path, timeout=60)
    (fault,) = json.loads(done.stdout)["faults"]
    assert FORM.fullmatch(fault["id"]) and fault["message"] == "body number 9 is outside 1..4"
