"""Elements at nodes and joints of FLEX bodies, against the finite-element equations and by balances.

The body is a truss of six nodes in all its modes.  Clamped at three nodes it obeys M u'' + K u = f, which is
solved here from the matrices alone.
"""

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.model.vectors import rotation_matrix
from flexmb_cli.run.mechanism_modes import Wish, flexible_modes
from flexmb_cli.run.outcome import Listener, Outcome, Run, RunOptions
from flexmb_cli.run.verify.verify import verify_deck
from flexmb_cli.solvers.constrained.element_rows import FlexibleElementRows
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from tests.dialects.vsdf.vsdf_decks import read
from tests.fe.trusses import truss, write_matrix

pytestmark = pytest.mark.long_motion
SEED, NODES = 5, 6
R, _, M, K = truss(SEED, NODES)
FREE = slice(9, None)  # freedoms of nodes 14, 15, 16; 11, 12, 13 are clamped
A, B = (3.0, -0.5, 0.8), (0.2, 2.5, -1.5)  # anchors on the ground


def fields_of(*values):
    return ",".join(f"{value:.17g}" for value in values)


BODY = """VSDF A TRUSS
BODY
    1 FLEX    0   11   12   13
FEMN
    1 TXT  nodes.txt
FEMM
    1 MM   M.mtx
FEMK
    1 MM   K.mtx
"""
CLAMPED = f"""{BODY}CLMP
    1   11   12   13
NODE
0,1,{fields_of(*A)}
0,2,{fields_of(*B)}
JOIN
 1,FIXD,0,,,1,11,12,,13
"""


@pytest.fixture
def folder(tmp_path):
    write_matrix(tmp_path / "M.mtx", M)
    write_matrix(tmp_path / "K.mtx", K)
    lines = [f"{11 + k} {fields_of(*r).replace(',', ' ')}" for k, r in enumerate(R)]
    (tmp_path / "nodes.txt").write_text("\n".join(lines) + "\n")
    return tmp_path


def mechanism(folder, cards, body=CLAMPED, end=0.4, step=0.1, method="RK45,1e-11"):
    text = f"{body}{cards}\nINTG\n {method}\nTIME\n {end},{step}\nEND\nSTAR\nSTOP\n"
    return flexible_mechanism(build_vsdf(read(text), Path(folder))[0], cached=False)[0]


def rows_of(*arguments, **options):
    blocks = list(FlexibleDynamics(mechanism(*arguments, **options)).rows())
    names = [field.name for field in fields(FlexibleElementRows) if "amplitude" not in field.name]
    found = {name: np.concatenate([getattr(block, name) for block in blocks]) for name in names}
    return type("Rows", (), found | {"total": np.concatenate([block.total for block in blocks])})


def stiffened(k_line, k_bushing):
    """K of the free nodes with a spring along the line from 16 to A and a bushing at 15."""
    along = (np.array(A) - R[5]) / np.linalg.norm(np.array(A) - R[5])
    more = np.zeros((9, 9))
    more[6:, 6:] = k_line * np.outer(along, along)
    more[3:6, 3:6] = np.diag(k_bushing)
    return K[FREE, FREE] + more


def test_springs_at_nodes_raise_the_frequencies_of_the_finite_element_matrices(folder):
    """Eigenvalues of (K + k e eᵀ, M), the spring being at rest; damping by the same matrices of dampers."""
    rest = np.linalg.norm(np.array(A) - R[5])
    cards = (
        "ELEMENTS\n"
        f"  SPRING lspr-1 from=0:1 to=1:16 stiffness=40 rest={rest:.17g} damping=0.3\n"
        "  BUSHING bush-1 from=0:2 to=1:15 k=(30,50,70) kr=(0,0,0) c=(0.1,0.2,0.3)"
    )
    # The bushing's ends lie apart: gravity is none, and its pull at the start is left out of the eigenvalues.
    found = flexible_modes(mechanism(folder, cards), Wish(), Run(Outcome("x"), RunOptions(), Listener()))
    stiffness, damping = stiffened(40, (30, 50, 70)), stiffened(0.3, (0.1, 0.2, 0.3)) - K[FREE, FREE]
    inverse = np.linalg.inv(M[FREE, FREE])
    first_order = np.block([[np.zeros((9, 9)), np.eye(9)], [-inverse @ stiffness, -inverse @ damping]])
    wanted = np.linalg.eigvals(first_order)
    wanted = np.sort(np.abs(wanted[wanted.imag > 0]))
    oscillating = found.modes.eigenvalues[found.modes.eigenvalues.imag > 0]
    assert np.sort(np.abs(oscillating)) == pytest.approx(wanted, rel=1e-6)


def test_a_bushing_and_gravity_bend_the_body_as_its_stiffness_says(folder):
    """(K + k) u = f: weight on all nodes by rows of M, a force on one, the bushing's ends apart at rest."""
    g, force = np.array([0.3, -2.0, 0.7]), np.array([0.5, 0.4, -0.6])
    loads = f"FORC\n 1,14,{fields_of(*force)}\nGRAV\n {fields_of(*g)}\n"
    cards = f"ELEMENTS\n  BUSHING bush-1 from=0:2 to=1:15 k=(30,50,70)\n{loads}OUTN\n 1,14,15,16"
    model = mechanism(folder, cards)
    found = flexible_modes(model, Wish(equilibrium=True), Run(Outcome("x"), RunOptions(), Listener()))
    load = M[FREE] @ np.tile(g, NODES)
    load[:3] += force
    load[3:6] -= np.diag([30.0, 50, 70]) @ (R[4] - B)
    wanted = np.linalg.solve(stiffened(0, (30, 50, 70)), load).reshape(3, 3)
    # Results of modes are in the axes of the body's frame, e1 from node 11 to 12.
    axes, eta = rotation_matrix(model.bodies[0].p), np.array(dict(found.position)["body 1 modal"])
    assert eta.size == 9
    assert np.array([axes @ point.shape @ eta for point in model.outputs]) == pytest.approx(wanted, abs=1e-8)


def pulls(t, u, v):
    """Forces (9,) on the nodes 14, 15, 16 displaced by u (9,) with the rates v, and pulls of the lines."""
    r, rate, f = R[3:] + u.reshape(3, 3), v.reshape(3, 3), np.zeros((3, 3))
    f[0] += np.array([0.5, 0.4, -0.6]) * np.sin(7 * t)
    f[1] -= np.array([30, 50, 70]) * (r[1] - B) + np.array([0.1, 0.2, 0.3]) * rate[1]
    found = []
    for k, foot, speed, law in (
        (2, np.array(A), 0 * rate[0], lambda s, w: 2 + 14 * s + 40 * s**3 + 0.3 * w + 0.05 * w**3),
        (0, np.array(B), 0 * rate[0], lambda s, w: 60 * max(s, 0) * max(0.0, 1 + 0.2 * w)),
        (1, r[2], rate[2], lambda s, w: 25 * s + 0.4 * w),
    ):  # fmt: skip
        d = r[k] - foot
        L = np.linalg.norm(d)
        found.append((L, (d @ (rate[k] - speed)) / L))
        pull = law(L - RESTS[len(found) - 1], found[-1][1])
        f[k] -= pull * d / L
        if len(found) == 3:
            f[2] += pull * d / L
        found[-1] += (-pull,)
    return f.ravel(), found


RESTS = (
    np.linalg.norm(np.array(A) - R[5]) - 0.1, np.linalg.norm(np.array(B) - R[3]) + 0.01,
    np.linalg.norm(R[4] - R[5]) + 0.05,
)  # fmt: skip
LINES = f"""ELEMENTS
  FUNCTION 7 polynomial 0 5 0 40
  FUNCTION 8 polynomial 0 0 0 0.05
  FUNCTION 9 sine 0 1 7
  SPRING lspr-1 from=0:1 to=1:16 stiffness=9 rest={RESTS[0]:.17g} damping=0.3 preload=2 curve=7 damper=8
  SPRING lspr-2 from=1:15 to=1:16 stiffness=25 rest={RESTS[2]:.17g} damping=0.4
  CABLE cabl-1 from=0:2 to=1:14 stiffness=60 rest={RESTS[1]:.17g} damping=0.2
  BUSHING bush-1 from=0:2 to=1:15 k=(30,50,70) kr=(0,0,0) c=(0.1,0.2,0.3)
FORC
 1,14,0.5,0.4,-0.6,0,9
OUTN
 1,14,15,16
"""


@pytest.mark.parametrize(("method", "near"), [("RK45,1e-11", 1e-8), ("RAD5,1e-9", 1e-6)])
def test_elements_at_nodes_move_the_body_as_the_finite_element_equations_do(folder, method, near):
    """Springs by curves, a cable that slackens, a bushing, a force; M u'' + K u = f by scipy."""
    rows = rows_of(folder, LINES, method=method)
    inverse = np.linalg.inv(M[FREE, FREE])

    def slope(t, z):
        return np.concatenate([z[9:], inverse @ (pulls(t, z[:9], z[9:])[0] - K[FREE, FREE] @ z[:9])])

    z = solve_ivp(slope, (0, 0.4), np.zeros(18), "DOP853", rows.time, rtol=1e-12, atol=1e-14).y.T
    assert rows.point_position == pytest.approx(R[3:] + z[:, :9].reshape(-1, 3, 3), abs=near)
    wanted = np.array([pulls(t, y[:9], y[9:])[1] for t, y in zip(rows.time, z, strict=True)])[:, [0, 2, 1]]
    assert {True, False} == set((wanted[:, 2, 2] < 0).tolist())  # taut, and slack
    for column, field in enumerate(("element_coordinate", "element_rate", "element_effort")):
        assert getattr(rows, field)[:, :3] == pytest.approx(wanted[:, :, column], abs=100 * near), field
    assert np.ptp(rows.total) < 100 * near


HINGED = f"""{BODY}NODE
0,1,{fields_of(*R[2])}
0,2,{fields_of(*R[5])}
JOIN
 1,REVO,{{}}
"""
ON_GROUND, ON_BODY = "0,1,2,1,13,16", "1,13,16,0,1,2"
RUBS = (
    "ELEMENTS\n"
    "  FRICTION fric-1 joint=1 dynamic=0.2 static=0.3 stribeck=0.5 creep=0.01 radius=0.05 "
    "preload=3\n"
    "GRAV\n"
    " 0.5,1,-2\n"
)


@pytest.mark.parametrize("sides", [ON_GROUND, ON_BODY])
def test_friction_at_a_joint_of_a_flexible_body_follows_its_reaction(folder, sides):
    """The effort by Stribeck's curve and the reaction across the axis; its work balances the energy."""
    rows = rows_of(
        folder,
        f"{RUBS}ELEMENTS\n  SPRING tspr-1 at=1.angle stiffness=8 rest=0.4 damping=0.2\nOUTN\n 1,13,16",
        body=HINGED.format(sides),
    )
    axis = rows.point_position[:, 1] - rows.point_position[:, 0]
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    force = rows.reaction_force[:, 0]
    N = 3 + np.linalg.norm(force - np.sum(force * axis, axis=1, keepdims=True) * axis, axis=1)
    v = 0.05 * rows.joint_rate[:, 0]
    mu = (0.2 + 0.1 * np.exp(-((v / 0.5) ** 2))) * np.tanh(v / 0.01)
    assert np.max(np.abs(v)) > 0.01
    assert rows.element_effort[:, 0] == pytest.approx(-mu * N, abs=1e-9)
    assert rows.element_power[:, 0] == pytest.approx(-mu * N * v, abs=1e-9)
    assert np.ptp(rows.total) < 1e-8


def test_a_motor_and_a_stop_at_a_joint_of_a_flexible_body_do_the_work_of_their_effort(folder):
    """∫ M dφ of the motor by Simpson's rule over the rows; the stop stores what it takes."""
    cards = (
        "ELEMENTS\n"
        "  FUNCTION 4 sine 1 6 9\n"
        "  MOTOR tmot-1 at=1.angle effort=4\n"
        "  STOP tsto-1 at=1.angle lower=-0.02 upper=0.05 stiffness=900\n"
    )
    rows = rows_of(folder, cards, body=HINGED.format(ON_GROUND), end=0.4, step=0.002)
    effort = (1 + 6 * np.sin(9 * rows.time)) * rows.joint_rate[:, 0]
    work = 0.002 / 3 * (effort[0:-2:2] + 4 * effort[1:-1:2] + effort[2::2]).sum()
    stored = rows.kinetic + rows.potential + rows.strain
    assert np.max(rows.joint_coordinate[:, 0]) > 0.05
    assert stored[-1] - stored[0] == pytest.approx(work, abs=1e-6)


FLYING = f"""{BODY}BODY
    2 RIGD
RIGI
2,2,0.1,0.2,0
0.1,0.2,0.2
POSI
2,{fields_of(*R[3])}
VELO
1,0.3,-0.2,0.1,0.5,-0.4,0.8
NODE
2,1,0,0,0
2,2,0.3,0.1,0.2
0,1,{fields_of(*A)}
JOIN
 1,SPHE,1,14,,2,1
"""


def verified(folder, cards):
    path = folder / "x.vsdf"
    path.write_text(f"{FLYING}{cards}\nINTG\n RK45,1e-9\nTIME\n 0.1,0.05\nEND\nSTAR\nSTOP\n")
    return verify_deck(str(path), RunOptions(), 1e-6)


def test_elements_at_nodes_agree_in_two_floating_frames(folder):
    lines = (
        "ELEMENTS\n"
        "  SPRING lspr-1 from=1:15 to=2:2 stiffness=20 rest=0.5 damping=0.1\n"
        "  SPRING lspr-2 from=0:1 to=1:16 stiffness=30 rest=1\n"
        "  CABLE cabl-1 from=1:13 to=1:15 stiffness=50 rest=0.2 damping=0.1\n"
    )
    found = verified(folder, f"{lines}OUTN\n 1,11,14")
    assert found.outcome.exit_code == 0, found.differences
    assert {"element effort", "element power"} <= {each.name for each in found.differences if each.scale > 0}


@pytest.mark.parametrize(
    ("card", "told"),
    [
        (
            "ELEMENTS\n  BUSHING bush-1 from=1:15 to=2:2 k=(20,20,20)",
            "bush-1: it acts along the axes of the frame of a FLEX body",
        ),
        (
            "JOIN\n 2,REVO,1,14,15,2,1,2\nELEMENTS\n  SPRING tspr-1 at=2.angle stiffness=20",
            "tspr-1: it acts in an angle of the frame of a FLEX body",
        ),
    ],
)
def test_what_acts_on_a_floating_frame_is_not_compared_with_another_frame(folder, card, told):
    found = verified(folder, card)
    assert found.outcome.exit_code == 2
    assert told in found.outcome.faults[-1].sentence
