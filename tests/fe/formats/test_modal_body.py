"""Bodies of modes and nodal masses in MBDyn's .fem files.

Expected: the body that the same stiffness and nodal masses give as matrices; the inertia of a body that turns
rigidly; the layout of MBDyn's manual, "Modal joint".
"""

import json

import numpy as np
import pytest
import scipy
from click.testing import CliRunner

from flexmb_cli.cli.modes import modes as modes_command
from flexmb_cli.errors import ModelError
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.fe.formats.matrix_file import FEFileFault
from flexmb_cli.fe.formats.mbdyn_fem import read_modal_file
from flexmb_cli.fe.formats.node_table import read_node_table
from flexmb_cli.fe.invariants import inertia_invariants
from flexmb_cli.fe.modal_body import _add_rotary_inertia
from flexmb_cli.model.flexible_body import FEFile, FlexibleInput
from tests.fe.formats.bar_files import K, market
from tests.fe.formats.bars import POINTS

COUNT = 8
MASSES = np.linspace(1.0, 2.0, 16)
PLACES = np.array(POINTS) - MASSES @ np.array(POINTS) / MASSES.sum()
NUMBERS = np.arange(101, 117)


def modes():
    """ω² and shapes (48, COUNT) of the free body, without rigid motions, not of unit modal mass."""
    values, shapes = scipy.linalg.eigh(K, np.diag(np.repeat(MASSES, 3)))
    scale = np.arange(1.0, COUNT + 1)
    return values[6 : 6 + COUNT] * scale**2, shapes[:, 6 : 6 + COUNT] * scale, scale**2


def text(**replaced):
    """A .fem file of the bar with nodal masses."""
    values, shapes, masses = modes()
    J = np.einsum("n,nij->ij", MASSES, [r @ r * np.eye(3) - np.outer(r, r) for r in PLACES])
    groups = {
        1: f"**    REV   NODE  NORMAL  ATTACHMENT CONSTRAINT REJECTED\n  REV0 16 {COUNT} 0 0 0",
        2: " ".join(map(str, NUMBERS)),
        3: " ".join(["0"] * COUNT),
        4: " ".join(["0"] * COUNT),
        **{5 + i: " ".join(f"{x:.17g}" for x in PLACES[:, i]) for i in range(3)},
        8: "\n".join(
            f"** MODE {k + 1}\n{rows(np.hstack([shapes[:, k].reshape(16, 3), np.zeros((16, 3))]))}"
            for k in range(COUNT)
        ),
        9: rows(np.diag(masses)),
        10: rows(np.diag(values)),
        11: rows(np.column_stack([MASSES, MASSES, MASSES, *np.zeros((3, 16))])),
        12: " ".join(f"{x:.17g}" for x in [MASSES.sum(), 0, 0, 0, *J.ravel()]),
    } | {int(key[1:]): value for key, value in replaced.items()}
    return "** MBDyn MODAL DATA FILE\n" + "".join(
        f"** RECORD GROUP {number}, OF THE BAR\n{content}\n" for number, content in groups.items() if content
    )


def rows(matrix):
    return "\n".join(" ".join(f"{x:.17g}" for x in row) for row in matrix)


def body_of(folder, content, **more):
    path = folder / "x.fem"
    path.write_text(content)
    table, file = read_node_table(path, "FEM"), FEFile(path, "FEM")
    given = FlexibleInput("body 1", file, file, table.numbers, table.positions, **more)
    return flexible_body(given, cached=False)


def test_the_body_is_that_of_stiffness_and_nodal_masses(tmp_path):
    """Modes may differ by their signs, which J1, J2 and C1 follow."""
    body, warnings = body_of(tmp_path, text())
    for name, matrix in (("M", np.diag(np.repeat(MASSES, 3))), ("K", K)):
        (tmp_path / name).write_text(market(matrix))
    files = [FEFile(tmp_path / name, "MM") for name in "MK"]
    expected, _ = flexible_body(FlexibleInput("body 1", *files, NUMBERS, PLACES, modes=COUNT), cached=False)
    assert not warnings
    sign = np.sign(np.sum(body.Phi * expected.Phi, axis=0))
    assert body.frequencies == pytest.approx(expected.frequencies, rel=1e-9)
    np.testing.assert_allclose(body.Phi * sign, expected.Phi, rtol=0, atol=1e-8)
    for name, factor in {"m": 1, "s0": 1, "J0": 1, "S1": sign, "C0": sign}.items():
        signed = getattr(body, name) * factor
        np.testing.assert_allclose(signed, getattr(expected, name), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(body.J1 * sign[:, None, None], expected.J1, rtol=0, atol=1e-7)
    both = np.outer(sign, sign)[:, :, None, None]
    np.testing.assert_allclose(body.J2 * both, expected.J2, rtol=0, atol=1e-7)


def test_a_deck_names_the_file_three_times(tmp_path):
    (tmp_path / "x.fem").write_text(text())
    cards = "".join(f"{word}\n    1 FEM  x.fem\n" for word in ("FEMN", "FEMM", "FEMK"))
    deck = f"VSDF x\nBODY\n1,FLEX,0\n{cards}TIME\n0.01,0.005\nEND\nSTAR\nSTOP\n"
    (tmp_path / "x.vsdf").write_text(deck)
    done = CliRunner().invoke(modes_command, [str(tmp_path / "x.vsdf"), "--json"])
    assert done.exit_code == 0, done.output
    (body,) = json.loads(done.stdout)["bodies"]
    values, _, masses = modes()
    assert body["frequencies"] == pytest.approx(np.sqrt(values / masses) / (2 * np.pi), rel=1e-9)
    assert body["mass"] == pytest.approx(24.0, rel=1e-12)


def test_fewer_modes_and_damping(tmp_path):
    body, _ = body_of(tmp_path, text(), modes=3, damping=(0.5, 1e-5, 0.01))
    omega = 2 * np.pi * body.frequencies
    assert np.diag(body.Dr) == pytest.approx(0.5 + 1e-5 * omega**2 + 0.02 * omega, rel=1e-12)
    assert len(omega) == 3


def test_rotary_inertia_turns_with_its_node():
    """A shape that is a rigid rotation: J1 = e~ J0 - J0 e~, C0 = -J0 e, for the whole body."""
    generator = np.random.default_rng(3)
    inertia, places = generator.uniform(0.1, 1.0, (4, 3)), generator.normal(size=(4, 3))
    e = np.array([0.36, 0.48, 0.8])
    Phi = np.cross(e, places).reshape(12, 1)
    found = dict(inertia_invariants(places, Phi, np.diag([1.0, 2.0, 3.0, 4.0])))
    _add_rotary_inertia(found, np.tile(e[:, None], (4, 1, 1)), inertia)
    crossed = np.cross(e, np.eye(3)).T
    J0 = found["J0"]
    np.testing.assert_allclose(found["J1"][0], crossed @ J0 - J0 @ crossed, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found["C0"][:, 0], -J0 @ e, rtol=0, atol=1e-12)


def test_modal_masses_of_another_mass_matrix_are_told(tmp_path):
    values, _, masses = modes()
    _, warnings = body_of(tmp_path, text(_9=rows(np.diag(1.02 * masses)), _10=rows(np.diag(1.02 * values))))
    assert "differ by 2.0e-02 from those of its nodal masses" in warnings[0].message


REFUSED = {
    "no nodal masses": ({"_11": ""}, "has no record group 11"),
    "no shapes": ({"_8": ""}, "are more than group 8 holds"),
    "masses by direction": ({"_11": rows(np.tile([1, 2, 1, 0, 0, 0], (16, 1)))}, "differ in its three"),
    "a rigid motion": ({"_10": rows(np.diag([0.0, *np.ones(7)]))}, "a mode of x.fem has no stiffness"),
    "a modal mass that is not positive": ({"_9": rows(-np.eye(8))}, "is not positive definite"),
    "an asymmetric stiffness": ({"_10": rows(np.triu(np.ones((8, 8))))}, "modal stiffness of x.fem is not"),
    "another inertia": ({"_12": " ".join(["23"] + ["0"] * 12)}, "record group 12 of x.fem differ"),
    "initial values": ({"_3": "0 0 1e-3 0 0 0 0 0"}, "record group 3 start deformed"),
    "rejected modes": ({"_1": "** h\nREV0 16 8 0 0 1"}, "rejected modes are not read"),
    "a number too few": ({"_7": "0 0"}, "record group 7 holds 2 numbers; expected 16"),
    "a number that is not finite": ({"_10": "1e999 " * 64}, "group 10 holds a number that is not finite, or"),
    "a word": ({"_7": "0 x"}, "expected numbers; read '0 x'"),
    "a heading without sizes": ({"_1": "** h\nREV0 16"}, "a revision and the numbers"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_files_that_cannot_be_used_are_refused(tmp_path, case):
    replaced, words = REFUSED[case]
    with pytest.raises((ModelError, FEFileFault), match=words):
        body_of(tmp_path, text(**replaced))


def test_modal_masses_below_what_rigid_motions_take_are_refused(tmp_path):
    """Shapes that are nearly translations; a tenth of their modal mass is less than their momentum takes."""
    shapes = np.tile(np.eye(3), (16, 1)) @ np.random.default_rng(1).normal(size=(3, COUNT)) * 1e3
    groups = "\n".join(
        f"** mode\n{rows(np.hstack([shapes[:, k].reshape(16, 3), np.zeros((16, 3))]))}" for k in range(COUNT)
    )
    with pytest.raises(ModelError, match="some motion would have negative energy"):
        body_of(tmp_path, text(_8=groups))


def test_shapes_with_rigid_motions_and_a_distant_origin_are_those_of_the_same_body(tmp_path):
    """What rigid motions leave of the modal masses is that of the shapes without them: all are above zero."""
    _, shapes, _ = modes()
    places = PLACES + (3.0, -2.0, 1.0)
    turns = np.random.default_rng(5).normal(size=(COUNT, 3))
    moved = shapes + 5.0 * np.stack([np.cross(turn, places).ravel() for turn in turns], axis=1)
    groups = "\n".join(
        f"** mode\n{rows(np.hstack([moved[:, k].reshape(16, 3), np.zeros((16, 3))]))}" for k in range(COUNT)
    )
    masses, stiffness = moved.T @ (np.repeat(MASSES, 3)[:, None] * moved), moved.T @ K @ moved
    position = {f"_{5 + i}": " ".join(f"{x:.17g}" for x in places[:, i]) for i in range(3)}
    body, warnings = body_of(
        tmp_path, text(_8=groups, _9=rows(masses), _10=rows(stiffness), _12="", **position)
    )
    m6 = np.block(
        [[body.m * np.eye(3), np.cross(body.s0, np.eye(3))], [np.cross(np.eye(3), body.s0), body.J0]]
    )
    coupling = np.vstack([body.S1, -body.C0])
    whole = np.block([[m6, coupling], [coupling.T, body.Mff]])
    free = scipy.linalg.eigh(np.pad(body.Kr, ((6, 0), (6, 0))), whole, eigvals_only=True)[6:]
    expected, _, scale = modes()
    assert np.sqrt(free) == pytest.approx(np.sqrt(expected / scale), rel=1e-6)
    assert not warnings


@pytest.mark.parametrize("more", [{"clamped": (101, 103, 109)}, {"attachment": (101,)}])
def test_other_bases_are_refused(tmp_path, more):
    with pytest.raises(ModelError, match="the modes of a \\.fem file are the basis"):
        body_of(tmp_path, text(), **more)


def test_another_file_is_refused(tmp_path):
    (tmp_path / "x").write_text("1 0 0 0\n")
    with pytest.raises(FEFileFault, match="is it a \\.fem file of MBDyn"):
        read_modal_file(tmp_path / "x")
