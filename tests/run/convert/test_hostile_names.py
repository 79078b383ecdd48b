"""A deck's file may have any name: a converted model has it as a word, no statement, card or element."""

import ast
import shutil
from pathlib import Path
from xml.etree import ElementTree

import pytest

from flexmb_cli.run.convert import converted

DECKS = Path(__file__).resolve().parents[3] / "decks"
QUOTED = '"+str(__import__("os").system("touch seen"))+"'
LINES = '"""\nimport os\nos.system("touch seen")\n"""\n\\N{x}'
CARDS = "} 9 9 9\nGRAV\n    0    0.0    0.0\n\x1b[2J{"
NAMES = (QUOTED, LINES, CARDS, "\udcff\x01<&'")


def both(tmp_path, deck, form, name):
    """The model of a supplied deck by its own name, and by another one."""
    source = DECKS / deck
    shutil.copy(source, tmp_path / f"{name}{source.suffix}")
    return converted(str(source), form), converted(str(tmp_path / f"{name}{source.suffix}"), form)


@pytest.mark.parametrize("name", NAMES, ids=range(len(NAMES)))
def test_a_name_adds_no_statement_to_a_script(name, tmp_path):
    """A name with a quotation mark was run by the script, as any Python."""
    plain, hostile = both(tmp_path, "young/dynamics/IN-BRICARD.dat", "exudyn", name)
    kinds = [[type(node) for node in ast.walk(ast.parse(text))] for text in (plain, hostile)]
    assert kinds[0] == kinds[1]
    hostile.encode("utf-8")


@pytest.mark.parametrize("name", NAMES, ids=range(len(NAMES)))
@pytest.mark.parametrize("form", ["young", "vsdf"])
def test_a_name_adds_no_line_to_a_deck(name, form, tmp_path):
    plain, hostile = both(tmp_path, "dafms/spatial_rigid.DAT", form, name)
    differing = [
        pair for pair in zip(plain.splitlines(), hostile.splitlines(), strict=True) if len(set(pair)) > 1
    ]
    assert len(differing) == 1 and "converted from" in differing[0][0]
    assert all(char.isprintable() for char in differing[0][1])


@pytest.mark.parametrize("name", NAMES, ids=range(len(NAMES)))
def test_a_model_for_mujoco_is_xml_whatever_its_name(name, tmp_path):
    """Control characters made it a file that no parser takes."""
    plain, hostile = (
        ElementTree.fromstring(t) for t in both(tmp_path, "dafms/spatial_rigid.DAT", "mjcf", name)
    )
    assert [item.tag for item in plain.iter()] == [item.tag for item in hostile.iter()]
