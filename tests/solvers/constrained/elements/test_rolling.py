"""Rolling without slip of discs, spheres and wheels: closed forms, all dialects, all integrators.

Values of the disc: `reference/motion`, problem rolling-disc-steady.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.errors import DeckError
from flexmb_cli.model.tree import Integration
from flexmb_cli.solvers.constrained.tree import AbsoluteTree
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.dialects.dafms.dafms_decks import build
from tests.dialects.vsdf.test_elements import rows_of as vsdf_rows
from tests.solvers.constrained.element_decks import METHODS, model_of, rows_of

LONG = [pytest.param(n, marks=() if n == "DOP853" else pytest.mark.long_motion) for n in METHODS]
FINE = "TOLERANCE 1e-11\n"
# Centre, axle, angular velocity and velocity at the start; time, centre, axle and angular velocity after it.
CIRCLE = (
    ((0.0, 0.102606042997701, 0.281907786235773), (0.0, -0.939692620785908, 0.342020143325669),
     (0.0, 6.534759741926254, -1.178458034142248), (1.963116568151263, 0.0, 0.0)),
    ((0.25, (0.4834505116, 0.175672441489, 0.281907786236), (0.277698157493, -0.897722649199, 0.342020143326),
      (-1.93115354942, 6.24289442913, -1.17845803414)),
     (1.0, (1.52475114319, 1.14574442361, 0.281907786236), (0.875830251367, -0.340504907966, 0.342020143326),
      (-6.09065149688, 2.36792086613, -1.17845803414)),
     (4.0, (-1.62965604018, 1.59539426305, 0.281907786236),
      (-0.936088532011, -0.0822221490643, 0.342020143326), (6.50969638215, 0.57178483444, -1.17845803414))),
)  # fmt: skip
EULER = (
    ((0.0, 0.297080420622471, 0.04175193028802), (0.0, -0.139173100960065, 0.99026806874157),
     (0.0, 3.14987342549675, -8.412514001122208), (2.630706493623239, 0.0, 0.0)),
    ((0.25, (-0.0659148367812, 0.660955362185, 0.041751930288),
      (-0.0488195895624, 0.130329581085, 0.990268068742), (1.10492276701, -2.94972003343, -8.41251400112)),
     (1.0, (0.186142657376, 0.459294063891, 0.041751930288),
      (0.137865897526, -0.0190301426746, 0.990268068742), (-3.1202877848, 0.430704929909, -8.41251400112)),
     (4.0, (-0.0980034005676, 0.32466147889, 0.041751930288),
      (-0.0725858702692, -0.118745288193, 0.990268068742), (1.64281964151, 2.68753534341, -8.41251400112))),
)  # fmt: skip
# About the axle z of the body.
INERTIA = (1.5 * 0.3**2 / 4, 1.5 * 0.3**2 / 4, 1.5 * 0.3**2 / 2)
LINE = "ELEMENTS\n  ROLL disc plane-disc from=0(0,0,0) normal=(0,0,1) to={} axis_to=(0,0,1) radius_to=0.3\n"


def numbers(*values):
    return " ".join(repr(float(x)) for x in values)


def disc(start, cards):
    """A YOUNG deck of the disc, whose axes are turned about x so that z is the axle."""
    centre, axle, spin, velocity = start
    turn = math.atan2(-axle[1], axle[2]) / 2.0
    body = numbers(*centre, math.cos(turn), math.sin(turn), 0, 0)
    text = f"2 0 0 0 0 0 0 0 0 0 0 1\n0 0 0 1 0 0 0\n{body}\n1 0 0 0 0 0 0\n"
    mass = f"MASS 2 1.5 0 0 0 {numbers(*INERTIA)}\nGRAVITY 0 0 -9.81\n"
    return text, f"{mass}VELOCITY 2 {numbers(*velocity, *spin)}\n{cards}{LINE.format('2(0,0,0)')}"


def axles(euler_parameters):
    e0, e1, e2, e3 = euler_parameters.T
    return np.stack([2 * (e1 * e3 + e0 * e2), 2 * (e2 * e3 - e0 * e1), 1 - 2 * (e1**2 + e2**2)], axis=1)


@pytest.mark.parametrize("name", LONG)
@pytest.mark.parametrize("problem", [CIRCLE, EULER], ids=["wide circle", "Euler's disc"])
def test_a_disc_rolls_in_steady_precession(problem, name):
    """Problem rolling-disc-steady, 1e-7 and 1e-6 in the angular velocity; GALF by its own tolerance."""
    start, values = problem
    card = {"DOP853": FINE, "RAD5": "RAD5 1e-10\n", "GALF": "GALF 0 0.9\nTOLERANCE 1e-6\n"}[name]
    end = 4.0 if name != "GALF" else 0.25
    rows = rows_of(*disc(start, f"{card}")[:1], f"0 {end} 0.25", disc(start, card)[1])
    near = 1e-7 if name != "GALF" else 1e-4
    for t, centre, axle, spin in values:
        if t > end:
            continue
        k = round(t / 0.25)
        assert rows.position[k, 1] == pytest.approx(centre, abs=near)
        assert axles(rows.euler_parameters[k, 1:2])[0] == pytest.approx(axle, abs=near)
        assert rows.angular_velocity[k, 1] == pytest.approx(spin, abs=10 * near)
    # The plane bears the disc and its acceleration.
    force = 1.5 * (rows.acceleration[:, 1] + (0.0, 0.0, 9.81))
    assert rows.roll_force[:, 0] == pytest.approx(force, abs=1e-8 if name != "GALF" else 1e-3)


SLOPE = math.radians(20)


@pytest.mark.parametrize("name", LONG)
@pytest.mark.parametrize(("shape", "share"), [("plane-sphere", 2 / 5), ("plane-disc", 1 / 2)])
def test_a_ball_and_a_disc_roll_down_a_slope(shape, share, name):
    """a = g sin 20° / (1 + J/(m R²)): 5/7 for a ball, 2/3 for a disc, and the force m (g - a) along it."""
    R, m, g = 0.2, 3.0, 9.81
    J = share * m * R * R
    gravity = numbers(g * math.sin(SLOPE), 0, -g * math.cos(SLOPE))
    axle = " axis_to=(0,1,0)" if shape == "plane-disc" else ""
    cards = (
        f"MASS 2 {m} 0 0 0 {J} {J} {J}\nGRAVITY {gravity}\n{METHODS[name]}ELEMENTS\n"
        f"  ROLL r {shape} from=0(0,0,-0.2) normal=(0,0,2) to=2(0,0,0) radius_to={R}{axle}\n"
    )
    free = "2 0 0 0 0 0 0 0 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 0 0 0 0 0 0\n"
    rows = rows_of(free, "0 2 0.5", cards)
    a = g * math.sin(SLOPE) / (1 + share)
    assert rows.position[:, 1, 0] == pytest.approx(a * rows.time**2 / 2, abs=1e-8)
    assert rows.angular_velocity[:, 1, 1] == pytest.approx(a * rows.time / R, abs=1e-7)
    along = m * (a - g * math.sin(SLOPE))
    assert rows.roll_force[:, 0] == pytest.approx(
        np.tile((along, 0.0, m * g * math.cos(SLOPE)), (5, 1)), abs=1e-7
    )


def test_a_ball_on_a_turntable_circles_at_two_sevenths_of_its_rate():
    """Weltner, American Journal of Physics 47 (1979): whatever the place and the speed of the start."""
    rate, R, m = 3.0, 0.05, 0.2
    J = 0.4 * m * R * R
    text = (
        "3 0 0 0 0 1 0 0 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n0.4 0 0.05 1 0 0 0\n"
        "1 2 0 0 0 0 0 0 0 0 1 0 0 1\n1 0 0 0 0 0 0\n"
    )
    # At rest without spin, the table slips past: the start takes the spin that rolls.
    cards = (
        f"MASS 2 1 0 0 0 1 1 1\nMASS 3 {m} 0 0 0 {J} {J} {J}\nGRAVITY 0 0 -9.81\n{FINE}"
        "VELOCITY 3 0 0.3 0\nELEMENTS\n  FUNCTION turn polynomial 0 3\n  DRIVE table at=1.angle value=turn\n"
        f"  ROLL ball plane-sphere from=2(0,0,0) normal=(0,0,1) to=3(0,0,0) radius_to={R}\n"
    )
    rows = rows_of(text, "0 4 0.05", cards)
    x, y = rows.position[:, 2, 0], rows.position[:, 2, 1]
    vx, vy = rows.velocity[0, 2, :2]
    w = 2.0 / 7.0 * rate
    # Centre of the circle: the velocity is w z × (r - r0).
    x0, y0 = x[0] - vy / w, y[0] + vx / w
    angle = w * rows.time
    assert x == pytest.approx(x0 + (x[0] - x0) * np.cos(angle) - (y[0] - y0) * np.sin(angle), abs=1e-8)
    assert y == pytest.approx(y0 + (x[0] - x0) * np.sin(angle) + (y[0] - y0) * np.cos(angle), abs=1e-8)
    assert np.ptp(x) > 0.3


PLANET = """4 0 0 0 0 3 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
0 0 0 1 0 0 0
0.3 0 0 1 0 0 0
1 2 0 0 0 0 0 0 0 0 1 0 0 1
1 3 0 0 0 0 0 0 0 0 1 0 0 1
3 4 0.3 0 0 0 0 0 0.3 0 1 0 0 1
1 0 0 0 0 0 0
"""


def planet(ring):
    """A sun (2), a carrier (3) and a planet of radius 0.1 (4) that rolls on it, and in a ring at rest."""
    wheels = "wheel-wheel from={}(0,0,0) axis_from=(0,0,1) radius_from={} to=4(0,0,0) radius_to=0.1\n"
    inside = f"  ROLL ring {wheels.format(0, -0.4)}" if ring else ""
    return (
        "MASS 2 1 0 0 0 1 1 0.02\nMASS 3 1 0 0 0 1 1 0.03\nMASS 4 0.5 0 0 0 1 1 0.004\n" + FINE
        + "ELEMENTS\n  FUNCTION pull polynomial 0.7\n  MOTOR m at=1.angle effort=pull\n"
        f"  ROLL sun {wheels.format(2, 0.2)}{inside}"
    )  # fmt: skip


def test_planetary_wheels_have_the_rates_of_willis():
    """Sun 0.2, planet 0.1, ring 0.4 m at rest: carrier = sun/3, planet = -sun; inertia seen by the sun."""
    rows = rows_of(PLANET, "0 2 0.1", planet(ring=True))
    sun, carrier, own = rows.angular_velocity[:, 1:, 2].T
    assert carrier == pytest.approx(sun / 3.0, abs=1e-9)
    assert own == pytest.approx(-sun, abs=1e-9)
    inertia = 0.02 + (0.03 + 0.5 * 0.3**2) / 9.0 + 0.004
    assert sun == pytest.approx(0.7 / inertia * rows.time, abs=1e-8)
    # The torque on the planet about its axle is that of both contacts.
    force = rows.roll_force[:, 0], rows.roll_force[:, 1]
    out = rows.position[:, 3] / 0.3
    tangent = np.stack([-out[:, 1], out[:, 0]], axis=1)
    of_sun, of_ring = (np.sum(f[:, :2] * tangent, axis=1) for f in force)
    assert 0.1 * (of_ring - of_sun) == pytest.approx(np.full(21, -0.004 * 0.7 / inertia), abs=1e-9)


def test_a_planet_without_a_ring_keeps_its_power():
    """Energy is the work of the motor, and the planet rolls on a sun that turns itself."""
    rows = rows_of(PLANET, "0 2 0.1", planet(ring=False))
    sun, carrier, own = rows.angular_velocity[:, 1:, 2].T
    assert 0.2 * (sun - carrier) == pytest.approx(-0.1 * (own - carrier), abs=1e-9)
    assert rows.kinetic == pytest.approx(rows.element_work[:, 0], abs=1e-9)


DISC_OF_TREE = f"""    1    2
DFMB DISC
    1    3    1    1    1
    1    3    1    1    1
    0
    0
   16
      0.25
CONN
    0
MASS
    1       1.5
INER
    1{INERTIA[0]:10.6f}{INERTIA[1]:10.6f}{INERTIA[2]:10.6f}
Q(k)
    1       0.0       0.0       0.0
EULT
    1       0.0       0.0       0.0       1.0
EULL
    1       0.0       0.0       0.0       1.0
GRAV
    0       0.0       0.0     -9.81
TOLR
    1.000E-11    1.000E-12
"""


def tree_of_disc(start, line=LINE):
    """The disc on a hinge with three rotations and three translations, at its place to all digits."""
    centre, axle, spin, velocity = start
    tree = build(f"{DISC_OF_TREE}{line.format('1(0,0,0)')}END \n")[0]
    turn = math.atan2(-axle[1], axle[2]) / 2.0
    hinge = replace(tree.hinges[0], attitude=(math.cos(turn), math.sin(turn), 0.0, 0.0))
    q = np.array([0.0, 0.0, 0.0, *centre])
    return replace(tree, hinges=(hinge,), q=q, y=np.array([*spin, *velocity]))


def tree_rows(analysis):
    blocks = list(analysis.rows())
    names = ("position", "euler_parameters", "angular_velocity", "acceleration", "roll_force")
    return [np.concatenate([getattr(block, name) for block in blocks]) for name in names]


@pytest.mark.parametrize(
    "method",
    ["dop853", *(pytest.param(m, marks=pytest.mark.long_motion) for m in ("sdirk4", "radau", "absolute"))],
)
@pytest.mark.parametrize("problem", [CIRCLE, EULER], ids=["wide circle", "Euler's disc"])
def test_a_disc_of_a_tree_rolls_in_steady_precession(problem, method):
    """The same problem by Kane's equations, and by those of the second formulation."""
    start, values = problem
    tree = tree_of_disc(start)
    if method in ("sdirk4", "radau"):
        tree = replace(tree, integration=Integration(method, 1e-9, 1e-10))
    analysis = AbsoluteTree(tree) if method == "absolute" else TreeAnalysis(tree)
    position, attitude, spin, acceleration, force = tree_rows(analysis)
    near = 1e-7 if method in ("dop853", "absolute") else 1e-5
    for t, centre, axle, angular in values:
        k = round(t / 0.25)
        assert position[k, 0] == pytest.approx(centre, abs=near)
        assert axles(attitude[k])[0] == pytest.approx(axle, abs=near)
        assert spin[k, 0] == pytest.approx(angular, abs=10 * near)
    expected = 1.5 * (acceleration[:, 0] + (0.0, 0.0, 9.81))
    assert force[:, 0] == pytest.approx(expected, abs=1e-8 if near == 1e-7 else 1e-3)


VSDF_DISC = (
    f"VSDF DISC\nBODY\n 1,RIGD\nRIGI\n 1,1.5,0,0,0\n {','.join(map(repr, INERTIA))},0,0,0\n"
    "NODE\n 1,1,0,0,0\nGRAV\n 0.0,0.0,-9.81\n"
)


def test_a_disc_of_a_vsdf_deck_rolls_as_that_of_a_young_deck():
    """Upright on its edge on a slope that is not along it, so that it turns and leans."""
    line = LINE.format("1:1").replace("axis_to=(0,0,1)", "axis_to=(0,1,0)").replace("0(0,0,0)", "0(0,0,-0.3)")
    inertia = f"{INERTIA[0]!r},{INERTIA[2]!r},{INERTIA[1]!r}"
    slope = VSDF_DISC.replace(",".join(map(repr, INERTIA)), inertia).replace("0.0,0.0,-9.81", "3.0,0.5,-9.0")
    found = vsdf_rows(slope, 0.4, 0.1, line)
    cards = f"MASS 2 1.5 0 0 0 {inertia.replace(',', ' ')}\nGRAVITY 3.0 0.5 -9.0\n{FINE}" + line.replace(
        "1:1", "2(0,0,0)"
    )
    other = rows_of(
        "2 0 0 0 0 0 0 0 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 0 0 0 0 0 0\n", "0 0.4 0.1", cards
    )
    assert np.ptp(found.position[:, 0, 1]) > 1e-3
    assert found.position[:, 0] == pytest.approx(other.position[:, 1], abs=1e-7)
    assert found.roll_force == pytest.approx(other.roll_force, abs=1e-6)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("plane-sphere normal=(0,0,1)", "plane-sphere needs radius_to="),
        ("plane-sphere normal=(0,0,1) radius_to=0.1 axis_to=(0,0,1)", "plane-sphere has no axis_to"),
        ("plane-sphere normal=(0,0,0) radius_to=0.1", "normal must have a direction"),
        ("plane-disc normal=(0,0,1) axis_to=(1,0,0) radius_to=0", "radius_to must be larger than 0"),
        ("wheel-wheel axis_from=(0,0,1) radius_from=-0.1 radius_to=0.2", "less than -0.2; read -0.1"),
    ],
)
def test_faults_of_rolling_are_named(line, message):
    cards = f"MASS 2 1 0 0 0 1 1 1\nELEMENTS\n  ROLL r {line} from=0(0,0,0) to=2(0,0,0)"
    with pytest.raises(DeckError) as refused:
        model_of("2 0 0 0 0 0 0 0 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 0 0 0 0 0 0\n", "0 1 0.5", cards)
    assert any(message in fault.message for fault in refused.value.faults)


def test_the_ground_does_not_roll():
    line = "ROLL r plane-sphere from=2(0,0,0) normal=(0,0,1) radius_to=1 to=0(0,0,0)"
    cards = f"MASS 2 1 0 0 0 1 1 1\nELEMENTS\n  {line}"
    with pytest.raises(DeckError) as refused:
        model_of("2 0 0 0 0 0 0 0 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 0 0 0 0 0 0\n", "0 1 0.5", cards)
    assert "the ground does not roll" in refused.value.faults[0].message
