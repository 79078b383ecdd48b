"""Every fault has a stable identifier, no two the same, and the page of messages lists them all."""

import json
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "docs" / "_ext"))
import fault_messages  # noqa: E402

FORM = re.compile(r"(CLI|DECK|DAFMS|DIFF|ELEMENTS|FE|FLEXMB|MODEL|RESULT|RUN|SOLVE|STUDY|VSDF|YOUNG)-\d{3}")
# Calls that pass on what another fault says, or many sentences of one kind.
CARRIERS = ("errors.py", "diagnostics.py", "quantities.py", "cluster.py")


def test_every_fault_has_an_identifier():
    without = [
        f'{path.relative_to(TOP)}:{call.lineno}: give it id="{fault_messages.proposal(path)}", or a later one'
        for path, call, _ in fault_messages.makers()
        if fault_messages.identifier(call) is None and path.name not in CARRIERS
    ]
    assert not without


def test_the_identifier_proposed_is_free_and_of_the_area_of_its_neighbours():
    """YOUNG-105 to YOUNG-129 are retired, and no fault was ever given VSDF-000."""
    used = {fault_messages.identifier(call) for _, call, _ in fault_messages.makers()}
    folder = fault_messages.PACKAGE / "dialects"
    for name, area in (
        ("vsdf/bodies.py", "VSDF"),
        ("young/new_file.py", "YOUNG"),
        ("dafms/hinges.py", "DAFMS"),
    ):
        found = fault_messages.proposal(folder / name)
        assert FORM.fullmatch(found) and found.startswith(f"{area}-")
        assert found not in used and found not in fault_messages.RETIRED


def test_no_two_faults_share_an_identifier():
    given = [fault_messages.identifier(call) for _, call, _ in fault_messages.makers()]
    assert not [name for name, count in Counter(filter(None, given)).items() if count > 1]
    assert all(FORM.fullmatch(name) for name in filter(None, given))


def test_the_page_of_messages_is_that_of_the_program():
    assert fault_messages.PAGE.read_text(encoding="utf-8") == fault_messages.page(), (
        "run `python docs/_ext/fault_messages.py`"
    )


def test_the_identifier_of_a_fault_that_is_gone_is_not_given_to_another():
    """Scripts rely on these: an identifier may go, but its number is not given to another fault."""
    given = {fault_messages.identifier(call) for _, call, _ in fault_messages.makers()} - {None, ""}
    assert len(given) > 400
    assert not given & set(fault_messages.RETIRED)
    assert set(filter(None, fault_messages.RETIRED.values())) <= given


def test_the_faults_of_elements_that_moved_out_of_young_are_retired():
    """YOUNG-105 to YOUNG-129 were the faults of functions and elements before all dialects had them."""
    given = {fault_messages.identifier(call) for _, call, _ in fault_messages.makers()}
    kept = {"YOUNG-121", "YOUNG-122", "YOUNG-123"}
    moved = {f"YOUNG-{number}" for number in range(105, 130)} - kept
    assert kept <= given
    assert all(fault_messages.RETIRED[name].startswith("ELEMENTS-") for name in moved)


def test_a_message_is_read_from_the_assignment_before_its_fault():
    """`friction` assigns two messages, the first of them inside a loop."""
    page = fault_messages.page()
    assert "| ELEMENTS-010 | … is a speed above 0; read … |" in page
    assert "| ELEMENTS-011 | a joint that turns needs the radius of its bearing |" in page


@pytest.mark.processes
def test_json_records_carry_the_identifiers(tmp_path):
    """The misplaced body number of the README."""
    text = (TOP / "decks/young/IN4-BAR.dat").read_text().replace("1 2 0 0 2 0 6.10", "1 9 0 0 2 0 6.10")
    command = [sys.executable, "-m", "flexmb_cli", "check", "--json", "-"]
    done = subprocess.run(command, input=text, capture_output=True, text=True, cwd=tmp_path, timeout=60)
    (fault,) = json.loads(done.stdout)["faults"]
    assert FORM.fullmatch(fault["id"]) and fault["message"] == "body number 9 is outside 1..4"
