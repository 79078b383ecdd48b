"""Every card after DYNAMICS: asked for by `flexmb new`, accepted by `check`, echoed, documented."""

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.deck.dialogue import Dialogue, draft_text, from_draft
from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.dialects.young.cards import BY_KEYWORD
from flexmb_cli.dialects.young.form import YoungForm
from tests.solvers.constrained.element_decks import FREE, ROTOR
from tests.solvers.constrained.elements.element_cases import CASES, Case

TOP = Path(__file__).parents[3]
_ROTOR = "MASS 2 1.5 0.3 0.1 0 0.2 0.3 0.5\n"
OTHERS = {
    "MASS": Case(ROTOR, _ROTOR),
    "GRAVITY": Case(ROTOR, f"{_ROTOR}GRAVITY 1 2 3\n"),
    "VELOCITY": Case(FREE, f"{_ROTOR}VELOCITY 2 1 2 3 0.1 0.2 0.3\n"),
    "TOLERANCE": Case(ROTOR, f"{_ROTOR}TOLERANCE 1e-7\n"),
    "GALF": Case(ROTOR, f"{_ROTOR}GALF 1e-3 0.9\n"),
    "RAD5": Case(ROTOR, f"{_ROTOR}RAD5 1e-7\n"),
    "GEOM": Case(ROTOR, f"{_ROTOR}GEOM 2 1 0.1 0.2 0.3\n"),
    "STL": Case(ROTOR, f"{_ROTOR}STL bar.stl 2 0.001\n"),
}
ALL = CASES | OTHERS
TRIANGLE = "solid a\nfacet normal 0 0 1\nouter loop\n" + "".join(
    f"vertex {p}\n" for p in ("0 0 0", "1 0 0", "0 1 0")
)  # fmt: skip
TRIANGLE += "endloop\nendfacet\nendsolid a\n"
every_card = pytest.mark.parametrize("keyword", BY_KEYWORD)
every_case = pytest.mark.parametrize("keyword", ALL)


def deck_text(keyword):
    case = ALL[keyword]
    return f"{case.mechanism}0 0.1 0.1\nDYNAMICS forward\n{case.cards}END\n"


def deck_of(text):
    return read_deck(decode("test.dat", text.encode()))


def numbers_of(deck):
    return sorted((name, number.value) for name, number in deck.numbers())


def typed(dialogue, line):
    assert [f.sentence for f in dialogue.answer(line) if f.severity == "error"] == [], line


def _parted(cards):
    """The cards, and last the lines of the block."""
    lines = cards.replace("\n      ", " ").splitlines()
    return [
        *(line for line in lines if line[0] != " " and line != "ELEMENTS"),
        [x.strip() for x in lines if x[0] == " "],
    ]


def dialogue_of(keyword, folder=Path()):
    """The dialogue after the deck's lines, Enter for what they leave out."""
    case, dialogue = ALL[keyword], Dialogue(YoungForm(folder, cards=True))
    for line in ("", "forward", *case.mechanism.splitlines(), "0 0.1 0.1"):
        typed(dialogue, line)
    *cards, block = _parted(case.cards)
    for line in cards:
        word, _, numbers = line.partition(" ")
        typed(dialogue, word.lower())
        asked = dialogue.question.entry.prefix
        if word == "STL":
            name, _, numbers = numbers.partition(" ")
            typed(dialogue, name)
        typed(dialogue, numbers)
        while dialogue.question.entry.prefix == asked:
            typed(dialogue, "")
    for line in ("END", *block, ""):
        typed(dialogue, line)
    assert dialogue.question is None
    return dialogue


@every_case
def test_a_card_typed_in_gives_the_numbers_of_the_deck(keyword, tmp_path):
    (tmp_path / "bar.stl").write_text(TRIANGLE)
    text = dialogue_of(keyword, tmp_path).text
    assert keyword in text or "ELEMENTS" in text or keyword in ("JOINTS", "RATE")
    assert numbers_of(deck_of(text)) == numbers_of(deck_of(deck_text(keyword)))


@every_card
def test_check_accepts_the_card_and_echo_explains_its_numbers(keyword, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("bar.stl").write_text(TRIANGLE)
    Path("IN.dat").write_text(deck_text(keyword))
    done = CliRunner().invoke(cli, ["check", "--echo", "IN.dat"])
    assert done.exit_code == 0, done.output
    card = BY_KEYWORD[keyword]
    record = deck_of(deck_text(keyword)).section(card.section)[0]
    lines = {line.split()[1]: line for line in done.output.splitlines() if f" {card.section}.1." in line}
    assert set(lines) == {f"{card.section}.1.{number.key}" for number in record.numbers}
    assert all(number.meaning in lines[f"{card.section}.1.{number.key}"] for number in record.numbers)


@every_card
def test_the_format_page_has_a_row_for_the_card(keyword):
    text = (TOP / "decks/young/FORMAT.md").read_text(encoding="utf-8")
    rows = [line for line in text.splitlines() if re.match(rf"\|[^|]*`{keyword}`", line)]
    assert len(rows) == 1


def _examples():
    """Keyword → example in the table of the tutorial."""
    text = (TOP / "docs/tutorial/motors-and-springs.md").read_text(encoding="utf-8")
    cells = re.findall(r"^\| `([A-Z0-9]+[^`]*)` \|", text, re.MULTILINE)
    # Lines of the block follow the cards.
    return {cell.split()[0]: cell for cell in reversed(cells)}


# The mechanism of the tutorial's table, with a driver and a simplified constraint to follow functions.
TUTORIAL = (
    "3 1 0 0 0 1 1 0 0 1 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 0 0 1 0 0 0\n2 6 0 0 0\n"
    "1 2 0 0 0 0 0 0 0 0 1 0 0 1\n2 3 1 0 0 0 0 0 2 0 0 1 0 0\n3 3 0\n1 0 0 0 0 0 0\n0 1 0.1\n"
)
PRELUDE = (
    "MASS 2 1 0 0 0 1 1 1\n"
    "MASS 3 1 0 0 0 1 1 1\n"
    "ELEMENTS\n"
    "  FUNCTION 1 table 0 0 1 2\n"
    "  FUNCTION 2 polynomial 0 1\n"
    "  FUNCTION 3 sine 0 1 2\n"
)


@every_card
def test_the_tutorial_shows_an_example_of_the_card(keyword):
    example = _examples()[keyword]
    others = [line for line in PRELUDE.splitlines() if line.split()[:2] != example.split()[:2]]
    deck = deck_of("\n".join([f"{TUTORIAL}DYNAMICS forward", *others, example, "END", ""]))
    build_young_dynamics(deck)
    assert deck.section(BY_KEYWORD[keyword].section)
    assert not deck.warnings


def test_a_draft_with_cards_goes_on_without_the_option_too():
    """Answers to questions of cards must not vanish in silence."""
    dialogue = dialogue_of("TSPRING")
    again = from_draft(YoungForm(), draft_text(dialogue))
    assert again.question is None
    assert again.text == dialogue.text


@pytest.mark.parametrize(
    ("card", "numbers", "said"),
    [
        ("MASS", "3 1 0 0 0 1 1 1", "mass 1: body must be within 1..2; read 3"),
        ("SPRING", "0 3 0 0 0 0 0 0 1 1", "spring 1: J must be within 0..2; read 3"),
        ("ELEMENTS", "SPRNG s at=1.angle", "there is no 'SPRNG' in ELEMENTS; is SPRING meant"),
        ("ELEMENTS", "SPRING s at=1.angle stiffness=o", "s: stiffness must be a number; read"),
        ("SPIN", "", "card 1: keyword must be one of MASS, FORCE"),
    ],
)
def test_a_slip_in_a_card_is_refused_at_once(card, numbers, said):
    dialogue = Dialogue(YoungForm(cards=True))
    for line in ("", "forward", *ROTOR.splitlines(), "0 0.1 0.1"):
        typed(dialogue, line)
    faults = dialogue.answer(card if card != "ELEMENTS" else "END")
    faults = dialogue.answer(numbers) if numbers else faults
    assert faults[0].sentence.startswith(said)


def test_kinematic_counts_must_balance_and_those_of_a_forward_run_need_not():
    for cards, refused in ((False, True), (True, False)):
        dialogue = Dialogue(YoungForm(cards=cards))
        typed(dialogue, "")
        if not refused:
            typed(dialogue, "")
        faults = dialogue.answer("2 0 0 0 0 1 0 0 0 0 0 1")
        assert bool(faults) == refused


def test_shapes_alone_open_with_geometry():
    dialogue = Dialogue(YoungForm(cards=True))
    kinematic = "1 1 0 0 0 0 0 0 0 5 0 0", "", "", "1 6 0 1 0", *(f"1 {k} 0" for k in range(1, 6)), "0 1 0.1"
    for line in ("", "geometry", *kinematic):
        typed(dialogue, line)
    assert "must be one of GEOM, STL, END" in dialogue.answer("MASS")[0].sentence
    for line in ("GEOM", "1 1 0.1 0.2 0.3 0 0 0 0 0 0", "END"):
        typed(dialogue, line)
    text = dialogue.text
    assert "\nGEOMETRY\n" in text and len(deck_of(text).section("shape")) == 1


def test_other_dialects_have_no_such_option():
    done = CliRunner().invoke(cli, ["new", "vsdf", "--cards", "-o", "-"], input="")
    assert done.exit_code == 2
    assert "new vsdf asks for all cards without --cards" in done.output


def test_a_deck_with_cards_through_a_pipe_passes_the_check(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lines = ["rotor", "forward", *ROTOR.splitlines(), "0 0.1 0.1", "MASS", "2 1 0 0 0 1 1 1 0 0 0"]
    lines += ["end", "SPRING tspring-1 at=1.angle stiffness=3 rest=1 damping=0.05"]
    done = CliRunner().invoke(cli, ["new", "young", "--cards"], input="".join(f"{line}\n" for line in lines))
    assert done.exit_code == 0, done.output
    text = Path("IN-NEW.dat").read_text()
    assert "\nELEMENTS\n  SPRING tspring-1 at=1.angle stiffness=3 rest=1 damping=0.05\n" in text
    assert text.endswith("MASS 2 1 0 0 0 1 1 1 0 0 0\nEND\n")
