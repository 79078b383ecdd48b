"""Decks with variables and included files read as the same decks with typed numbers, others as before."""

import hashlib
import re
from pathlib import Path

import h5py
import numpy as np
import pytest

from flexmb_cli import interface
from flexmb_cli.deck.expansion.includes import is_expandable
from flexmb_cli.deck.record import DeckText
from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.recognise import open_text, read_deck
from flexmb_cli.dialects.settings import SettableDeck
from flexmb_cli.errors import DeckError, FlexmbError, compiler_style
from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.outcome import RunOptions

DECKS = Path(__file__).resolve().parents[3] / "decks"
SUPPLIED = sorted(
    path
    for path in DECKS.rglob("*")
    if path.suffix in (".dat", ".DAT", ".vsdf") and not is_expandable(path.read_text())
)
ARM = (DECKS / "dafms/arm_elements.DAT").read_text()


def written(folder, text, name="x.dat"):
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(text)
    return str(folder / name)


def numbers(path, changes=()):
    return {name: number.value for name, number in read_deck(open_text(path, changes=changes)).numbers()}


def faults(path):
    text = open_text(path)
    with pytest.raises(DeckError) as failure:
        read_deck(text)
    return compiler_style("x.dat", failure.value.faults, text.lines).replace(str(Path(path).parent), "…")


WORDS = "SET a = 0.3 $a $b ${c} $(d) INCLUDE none.inc"


def mangled(text):
    """Words of variables in titles and comments of a deck, as a historic one may have them."""
    if text.startswith("VSDF"):
        head, _, rest = text.partition("\n")
        return f"{head[:20]} {WORDS[:30]} {{\n*SET a = 0.3 $a\n* {WORDS} {{\n{rest}\n{WORDS}\n"
    if re.match(r"[ \d]+\n(.*\n){0,9}DFMB", text):
        return re.sub(r"(?m)^(DFMB.*)$", rf"\1 {WORDS[:30]} {{", text) + f"\nSET a = 0.3\n{WORDS}\n{{"
    words = WORDS.replace("{c}", "c")
    return f"{{{words}\nSET a = 0.3\nINCLUDE none.inc\n}}\n{text}{{ {words} }}\n"


@pytest.mark.parametrize("path", SUPPLIED, ids=lambda path: path.name)
def test_words_in_comments_and_titles_of_supplied_decks_mean_nothing(path):
    plain = read_text(str(path))
    text = DeckText(path.name, mangled(plain.text), "")
    assert text.text != plain.text
    titles = ("title.", "heading.")
    read, before = read_deck(text), read_deck(plain)
    assert [(name, n.value) for name, n in read.numbers() if not name.startswith(titles)] == [
        (name, n.value) for name, n in before.numbers() if not name.startswith(titles)
    ]
    assert not read.variables


def test_a_card_of_columns_takes_all_digits_and_leaves_the_other_columns(tmp_path):
    text = ARM.replace("    1       1.5\n", "    1        $m\n")
    text = text.replace("    0       0.0     -9.81       0.0", "    0       0.0       -$g       0.0")
    text = text.replace("    1    0    0    1\n", "    1    0    0   $n\n", 1).replace(
        "       .01\n", "       $dt\n"
    )
    path = written(tmp_path, f"SET m = g/3\nSET g = 9.81\nSET n = 1\nSET dt = 0.01\n{text}")
    wanted = numbers(written(tmp_path, ARM, "plain.dat"))
    assert numbers(path) == wanted | {"mass.1.BM": 9.81 / 3}
    source = read_deck(open_text(path)).source
    assert "    1      3.27\n" in source.text and "     -9.81       0.0" in source.text
    assert "$" not in source.text and "SET" not in source.text
    assert source.sha256 == hashlib.sha256(source.text.encode()).hexdigest()
    assert numbers(path, ["g=6"])["mass.1.BM"] == 2.0
    third = written(tmp_path, "SET m = 1/3\n" + ARM.replace("       1.5\n", "        $m\n", 1))
    assert numbers(third)["mass.1.BM"] == 1 / 3
    assert ".333333333\n" in open_text(third).text


def test_a_variable_over_the_edge_of_its_columns_is_a_fault(tmp_path):
    text = ARM.replace("    0       0.0     -9.81       0.0", "    0       0.0         $g      0.0")
    shown = faults(written(tmp_path, f"SET g = 9.81\n{text}"))
    assert "x.dat:35:25: error: g = 9.81 stands where no number is read" in shown
    assert "0       0.0         $g" in shown
    text = ARM.replace("    1       1.5\n", "    1$m-5\n")
    assert "needs more than 2 columns" in faults(written(tmp_path, f"SET m = 100.25\n{text}"))


def test_free_text_and_blocks_take_formulas(tmp_path):
    text = (DECKS / "young/IN4-BAR.dat").read_text()
    plain = numbers(str(DECKS / "young/IN4-BAR.dat"))
    name = next(name for name, v in plain.items() if isinstance(v, float) and v == 6.1)
    path = written(tmp_path, "{ title }\nSET long = 12.2\n" + text.replace(" 6.10 ", " $(long/2) "))
    assert numbers(path) == plain
    assert numbers(path, ["long=2"])[name] == 1.0
    path = written(tmp_path, "SET k = 2\n" + ARM.replace("stiffness=3.0", "stiffness=$(k+1)"))
    assert numbers(path)["elbow.stiffness"] == 3.0


def test_vsdf_cards_by_columns_and_by_commas(tmp_path):
    text = (DECKS / "vsdf/freeflying.vsdf").read_text()
    assert "       1.0" in text
    plain = numbers(str(DECKS / "vsdf/freeflying.vsdf"))
    swapped = text.replace("       1.0", "      $one")
    path = written(tmp_path / "vsdf", f"SET one = 0.5*2\n{swapped}")
    (tmp_path / "vsdf/fe").symlink_to(DECKS / "vsdf/fe")
    assert numbers(path) == plain


def test_included_files_are_part_of_the_deck_with_their_places(tmp_path):
    written(tmp_path, "GRAV\n    0       0.0       $g       0.0\n", "parts/load.inc")
    written(tmp_path, "SET g = -9.81\nINCLUDE parts/load.inc\n", "all.inc")
    text = ARM.replace("GRAV\n    0       0.0     -9.81       0.0\n", "INCLUDE all.inc\n")
    path = written(tmp_path, f"SET h = 1\n{text}")
    assert numbers(path) == numbers(written(tmp_path, ARM, "plain.dat"))
    assert "-9.81" in open_text(path).text and "INCLUDE" not in open_text(path).text
    written(tmp_path, "GRAV\n    0       0.0      9.8x       0.0\n", "parts/load.inc")
    assert "…/parts/load.inc:2:22: error: GRAV" in faults(path)
    outcome = check_deck(path, RunOptions()).outcome
    fault = next(one for one in outcome.as_dict()["faults"] if one["severity"] == "error")
    assert fault["file"].endswith("parts/load.inc") and (fault["line"], fault["column"]) == (2, 22)
    with pytest.raises(FlexmbError, match=r"parts/load.inc:2:22: "):
        interface.read_deck(path)


@pytest.mark.parametrize(
    ("lines", "sentence"),
    {
        "INCLUDE x.dat": "x.dat:1:9: error: x.dat: includes itself",
        "INCLUDE none.inc": "x.dat:1:9: error: none.inc: no such file",
        "INCLUDE ../other.inc": "lies outside the folder of the deck",
        "INCLUDE /etc/hosts": "lies outside the folder of the deck",
        "INCLUDE out.inc": "lies outside the folder of the deck",
        "SET a": "x.dat:1:1: error: write SET name = formula",
        "SET a = 1\nSET a = 2": "x.dat:2:5: error: a is defined twice",
        "SET a = (1": "x.dat:1:11: error: a: ')' is missing",
        "SET a = b\nSET b = a": "x.dat:2:5: error: the variable b is defined by itself: a → b → a",
        "SET pi = 3": "pi is a constant already",
        "SET a = 1\n{ $b } 4 $b": "x.dat:2:10: error: no line SET defines b; the deck has a",
    }.items(),
)  # fmt: skip
def test_wrong_statements_are_faults_with_their_places(tmp_path, lines, sentence):
    (tmp_path / "out.inc").symlink_to("/etc/hosts")
    text = (DECKS / "young/IN4-BAR.dat").read_text()
    assert sentence in faults(written(tmp_path, f"{lines}\n{text}"))


def test_runs_studies_and_settings_know_variables(tmp_path):
    young = (DECKS / "young/IN-RSSR.dat").read_text()
    names = numbers(str(DECKS / "young/IN-RSSR.dat"))
    path = written(tmp_path, f"SET end = 0.2\nSET step = end/20\n{young}")
    deck = SettableDeck(read_deck(open_text(path)))
    assert "end" in deck and names
    with pytest.raises(DeckError, match="no number 'stop'"):
        deck.with_settings(["stop=1"])
    text = ARM.replace("stiffness=3.0", "stiffness=$(2*k)")
    path = written(tmp_path, f"SET k = 1.5\n{text}", "arm.DAT")
    assert interface.solve_to_files(path, RunOptions(folder=str(tmp_path), changes=("k=4",))).exit_code == 0
    plain = written(tmp_path, ARM, "plain.DAT")
    changes = ("elbow.stiffness=8",)
    assert interface.solve_to_files(plain, RunOptions(folder=str(tmp_path), changes=changes)).exit_code == 0
    with h5py.File(tmp_path / "arm.h5") as one, h5py.File(tmp_path / "plain.h5") as other:
        assert np.array_equal(one["element/effort"][:], other["element/effort"][:])
        assert one.attrs["settings"] == "k=4"
        assert b"stiffness=8 " in one["deck"][()]
    study = 'deck = "arm.DAT"\n[parameters]\nk = [1.5, 4]\n[results]\nm = "last element.elbow.effort"\n'
    found = interface.sweep(written(tmp_path, study, "study.toml"))
    assert found["parameter/k"].tolist() == [1.5, 4.0] and found["exit_code"].tolist() == [0, 0]
    with h5py.File(tmp_path / "arm.h5") as one:
        assert found["result/m"][1] == one["element/effort"][-1, 0]


def test_a_variable_in_a_count_is_set_by_run_and_refused_by_studies(tmp_path):
    text = ARM.replace("  100\n", "   $n\n")
    path = written(tmp_path, f"SET n = 100\n{text}")
    assert numbers(path, ["n=50"])["time.IT"] == 50
    assert (
        dict(SettableDeck(read_deck(open_text(path))).with_settings(["n=50"]).numbers())["time.IT"].value
        == 50
    )
    with pytest.raises(DeckError, match="must be an integer"):
        SettableDeck(read_deck(open_text(path))).with_settings(["n=50.5"])


def test_the_supplied_deck_with_variables_is_driven_as_its_included_file_says():
    """rate t and fast t - slower t^2 at the end of 3 s, by the numbers of the deck and of its file."""
    found = interface.solve(str(DECKS / "dafms/variables/driven_pair.DAT"))
    assert found["coordinate/q"][-1] == pytest.approx([1.3 * 3, 2 * 3 - 0.4 * 9], abs=1e-12)
    assert len(found.time) == 61
