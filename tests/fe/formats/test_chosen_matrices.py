"""Which matrix is meant where a file holds several: names of Nastran's own alters, and names on card FEMX.

Expected: frequencies of scipy.linalg.eigh of the numbers in tests/fe/formats/bar.
"""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.linalg import eigh

from flexmb_cli.cli.check import check
from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.dialects.vsdf.reader import read_vsdf
from flexmb_cli.fe.formats.formats import read_matrix
from tests.fe.formats.bar_files import (
    FREQUENCIES,
    MASS,
    K,
    M,
    abaqus_nodes,
    abaqus_rows,
    bar_of,
    dmig,
    market,
    op4_binary,
    op4_text,
    refused,
)

DECKS = Path(__file__).resolve().parents[3] / "decks"
LOADS = np.arange(1.0, 97.0).reshape(48, 2)
HALF = K[:24, :24]
COMPANIONS = dmig("VAX", LOADS, 9) + dmig("MUG1T", LOADS, 9) + dmig("K4AAX", 0.02 * K)


def test_the_frequencies_are_those_of_scipy():
    values = eigh(K, M, eigvals_only=True)[6:9]
    assert np.sqrt(values) / (2 * np.pi) == pytest.approx(FREQUENCIES, rel=1e-7)


PUNCHES = {
    "companions": COMPANIONS + dmig("KAAX", K) + COMPANIONS.replace("VAX", "PAX") + dmig("MAAX", M),
    "KAA and MAA beside the stiffness of other points": dmig("KGG", HALF) + dmig("KAA", K) + dmig("MAA", M),
    "names that Nastran does not give": dmig("K2", K) + dmig("M2", M) + dmig("MUG1", LOADS, 9),
    "STIFF and MASS": dmig("STIFF", K) + dmig("MASS", M),
}
PUNCHES["companions"] = PUNCHES["companions"].replace("MUG1T", "MUGX", 1).replace("K4AAX", "K4XX", 1)


@pytest.mark.parametrize("name", PUNCHES)
def test_a_punch_file_gives_the_matrices_meant(tmp_path, name):
    mass, found = bar_of(tmp_path, ("DMIG", PUNCHES[name]), ("DMIG", PUNCHES[name]))
    assert mass == pytest.approx(MASS, rel=1e-8)
    assert found == pytest.approx(FREQUENCIES, rel=2e-7)


OTHERS = {
    "OP4 text": (
        "OP4",
        *[
            op4_text("K4XX", 0.02 * np.eye(3), form=6) + op4_text("PA", LOADS) + op4_text("KAA", K, form=6),
            op4_text("MUG1", np.hstack([LOADS, LOADS]), kind=4) + op4_text("MAA", M, form=6),
        ],
    ),
    "Abaqus sections": (
        "ABQ",
        *[
            "** made by hand\n*MATRIX INPUT, NAME=STIF\n" + abaqus_nodes(K),
            "*MATRIX INPUT, NAME=DMPV\n1,1,1,1,7.0\n*Matrix Input, name=Mass\n" + abaqus_nodes(M),
        ],
    ),
    "Abaqus types": (
        "ABQ",
        "*MATRIX,TYPE=MASS\n",
        abaqus_rows(M) + "*MATRIX, TYPE=STIFFNESS\n" + abaqus_rows(K),
    ),
}


@pytest.mark.parametrize("name", OTHERS)
def test_other_formats_give_the_matrices_meant(tmp_path, name):
    form, *parts = OTHERS[name]
    mass, found = bar_of(tmp_path, (form, "".join(parts)), (form, "".join(parts)))
    assert (mass, *found) == pytest.approx((MASS, *FREQUENCIES), rel=1e-7)


def test_a_binary_op4_gives_the_matrices_meant(tmp_path):
    raw = op4_binary(
        ("K4AA", K * 0.01), ("PA", LOADS), ("VAX", LOADS * 1j), ("KAA", K), ("MAA", M), ("MUG1T", LOADS.T)
    )
    mass, found = bar_of(tmp_path, ("OP4", raw), ("OP4", raw))
    assert (mass, *found) == pytest.approx((MASS, *FREQUENCIES), rel=1e-7)


SEVERAL = dmig("KMESH1", 2 * K) + dmig("KMESH2", K) + dmig("WEIGHT", M)
NAMES = "FEMX\n    1 K    kmesh2\n    1 M    WEIGHT\n"


def test_the_card_names_the_matrices_in_every_format(tmp_path):
    for form, text in (
        ("DMIG", SEVERAL),
        ("OP4", op4_text("KMESH1", 2 * K) + op4_text("KMESH2", K) + op4_text("WEIGHT", M)),
        ("OP4", op4_binary(("KMESH1", 2 * K), ("KMESH2", K), ("WEIGHT", M))),
        (
            "ABQ",
            "".join(
                f"*MATRIX INPUT,NAME={n}\n{abaqus_nodes(A)}"
                for n, A in (("KMESH1", 2 * K), ("KMESH2", K), ("WEIGHT", M))
            ),
        ),
    ):
        mass, found = bar_of(tmp_path, (form, text), (form, text), cards=NAMES)
        assert (mass, *found) == pytest.approx((MASS, *FREQUENCIES), rel=1e-7)


@pytest.mark.parametrize(
    ("text", "cards", "words"),
    [
        (
            SEVERAL,
            "FEMX\n    1 M    WEIGHT\n",
            "2 may be meant (KMESH1, KMESH2); name a square real one on a card FEMX",
        ),
        (
            SEVERAL,
            NAMES.replace("WEIGHT", "MAAX"),
            "holds KMESH1, KMESH2, WEIGHT: no MAAX among them is meant",
        ),
        (
            dmig("VAX", LOADS, 9) + dmig("MUG1", LOADS, 9),
            "",
            "holds VAX, MUG1: no M among them is meant; name a square real one",
        ),
        (dmig("KAAX", K) + dmig("MAAX", M) + dmig("MAAX", M), "", "DMIG MAAX begins again, after line"),
        (
            dmig("KAAX", K) + (twice := dmig("MAAX", M)) + twice.partition("\n")[2],
            "",
            "DMIG MAAX repeats entries, such as that of 1, 1 with 1, 1; give each once",
        ),
        (SEVERAL, NAMES + "    1 K    KMESH1\n", "matrix K of body 1 has a name already"),
        (SEVERAL, NAMES + "    1 KG   KDGG\n", "body 1 has no card FEMG, whose matrix it could name"),
    ],
)
def test_what_may_be_meant_is_named(tmp_path, text, cards, words):
    assert words in refused(tmp_path, ("DMIG", text), ("DMIG", text), cards=cards)


STRUCTURAL_ALONE = {
    "alone": (dmig("K4AAX", 0.02 * K), ""),
    "beside others": (dmig("KAAX", K) + dmig("MAAX", M) + dmig("K4AAX", 0.02 * K), ""),
    "by its name": (dmig("BAAX", K) + dmig("K4AAX", 0.02 * K), "FEMX\n    1 B    K4AAX\n"),
    "of Abaqus": ("*MATRIX,TYPE=STRUCTURAL DAMPING\n" + abaqus_rows(0.02 * K), ""),
}


@pytest.mark.parametrize("case", STRUCTURAL_ALONE)
def test_structural_damping_is_no_viscous_damping(tmp_path, case):
    text, cards = STRUCTURAL_ALONE[case]
    (tmp_path / "damping").write_text(text)
    cards = f"FEMD\n    1 {'ABQ ' if case == 'of Abaqus' else 'DMIG'} damping\n{cards}"
    words = refused(tmp_path, ("DMIG", dmig("M", M)), ("DMIG", dmig("K", K)), cards=cards)
    assert re.search(r"damping: (K4AAX|STRUCTURAL ?DAMPING) is structural damping, .* on DAMF or DAMP", words)


def test_structural_damping_is_no_stiffness(tmp_path):
    mass = ("DMIG", dmig("M", M))
    assert "K4AAX is structural damping" in refused(tmp_path, mass, ("DMIG", dmig("K4AAX", 0.02 * K)))


def test_two_op4_matrices_of_one_name_are_refused(tmp_path):
    for text in (
        op4_text("KAA", K) + op4_text("MAA", M) + op4_text("KAA", K),
        op4_binary(("KAA", K), ("MAA", M), ("KAA", K)),
    ):
        assert "holds KAA, MAA, KAA: 2 may be meant (KAA)" in refused(tmp_path, ("OP4", text), ("OP4", text))


def test_a_format_without_names_refuses_one(tmp_path):
    said = refused(tmp_path, ("MM", market(M)), ("MM", market(K)), cards=NAMES)
    assert "matrices of format MM have no names; remove kmesh2 from card FEMX" in said


def test_a_geometric_stiffness_is_the_one_named_or_the_one_of_kind_k(tmp_path):
    text = op4_text("PA", 2 * K) + op4_text("DIFF", K) + op4_text("KDJJ", M)
    (tmp_path / "g.op4").write_text(text)
    for name, expected in (("diff", K), ("", M)):
        found = read_matrix(tmp_path / "g.op4", "OP4", "G", name=name)
        dense = np.zeros_like(K)
        dense[found.rows, found.columns] = found.values
        assert dense == pytest.approx(expected, rel=1e-15)


def test_the_card_names_the_geometric_stiffness_of_unit_loads(tmp_path):
    supplied = (DECKS / "vsdf/spinup.vsdf").read_text()
    text = supplied.replace(" MM   fe/spinup_KG", " OP4  fe/spinup_KG").replace(
        "NSET\n", "FEMX\n    1 KG   KDIFF\nNSET\n", 1
    )
    (tmp_path / "fe").mkdir()
    shutil.copy(DECKS / "vsdf/fe/spinup_nodes.txt", tmp_path / "fe")
    (tmp_path / "x.vsdf").write_text(text)
    model, _ = build_vsdf(read_vsdf(read_text(tmp_path / "x.vsdf")), tmp_path)
    loads = model.bodies[0].flexible.unit_loads
    assert [load.file.matrix for load in loads] == ["KDIFF", "KDIFF"]


def test_echo_shows_the_names_and_set_says_that_it_changes_numbers_only(tmp_path):
    bar_of(tmp_path, ("DMIG", SEVERAL), ("DMIG", SEVERAL), cards=NAMES)
    done = CliRunner().invoke(check, [str(tmp_path / "x.vsdf"), "--echo"])
    assert "matrix_name.1.name       kmesh2  -     name of the matrix that is meant" in done.output
    done = CliRunner().invoke(check, [str(tmp_path / "x.vsdf"), "--set", "matrix_name.1.name=KMESH1"])
    assert done.exit_code == 2
    assert "matrix_name.1.name must be a number; read 'KMESH1'" in done.output
