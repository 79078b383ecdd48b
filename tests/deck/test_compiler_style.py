"""Faults as compilers print them."""

from flexmb_cli.errors import SHOWN_FAULTS, SHOWN_LINE, Fault, Place, compiler_style


def test_place_severity_object_message_line_and_caret():
    fault = Fault("error", "body number 9 is outside 1..4", Place(2, 3), "universal joint 1")
    assert compiler_style("decks/IN4-BAR.dat", [fault], ["4 1", "1 9 0"]) == (
        "decks/IN4-BAR.dat:2:3: error: universal joint 1: body number 9 is outside 1..4\n    1 9 0\n      ^"
    )


def test_a_fault_without_place_shows_no_line():
    assert compiler_style("none.dat", [Fault("error", "no such file")]) == "none.dat: error: no such file"


def test_a_long_line_is_cut_around_the_caret():
    line = "0 " * 5000 + "x" + " 0" * 5000
    text = compiler_style("x", [Fault("error", "m", Place(1, 10_001))], [line]).split("\n")
    assert len(text[1]) == 4 + SHOWN_LINE + 2
    assert text[1].index("x") == text[2].index("^")
    assert text[1][4] == text[1][-1] == "…"


def test_a_crowd_of_warnings_hides_no_error():
    faults = [Fault("warning", f"w{k}") for k in range(50)] + [Fault("error", "e")]
    shown = compiler_style("x", faults).split("\n")
    assert shown[0] == "x: warning: w0"
    assert shown[-2:] == ["x: error: e", f"x: {51 - SHOWN_FAULTS} more faults not shown"]


def test_control_characters_of_a_deck_do_not_reach_the_terminal():
    text = compiler_style("x", [Fault("error", "read \x1b[2J", Place(1, 1))], ["\x1b[2J\t1"])
    assert text == "x:1:1: error: read �[2J\n    �[2J\t1\n    ^"


def test_a_fault_as_a_record_has_line_and_column_or_none():
    assert Fault("error", "m", Place(2, 3, 4), "body 1").as_dict() == {
        "id": "",
        "severity": "error",
        "object": "body 1",
        "message": "m",
        "line": 2,
        "column": 3,
    }
    assert Fault("note", "m").as_dict()["line"] is None


def test_an_object_that_the_message_names_is_in_the_record_only():
    fault = Fault("error", "at t = 1 s joint 1 is open", about="joint 1")
    assert fault.sentence == "at t = 1 s joint 1 is open"
    assert fault.as_dict()["object"] == "joint 1"
