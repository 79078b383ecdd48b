"""Contacts of shapes in decks of all dialects, against closed forms and problems of `reference/motion`."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from flexmb_cli.dialects.elements_block.words import OF_FIRST, OF_SECOND
from flexmb_cli.kernels import contact as kernel
from flexmb_cli.kernels import contact_shapes
from flexmb_cli.model.arrays import contacts as arrays
from flexmb_cli.model.laws import CONTACT, PAIRS
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.dialects.dafms.dafms_decks import build
from tests.dialects.dafms.test_dafms_elements import TWO_LINKS, deck
from tests.dialects.dafms.test_dafms_elements import rows_of as dafms_rows
from tests.dialects.vsdf.test_elements import rows_of as vsdf_rows
from tests.solvers.constrained.element_decks import FREE, analysis_of, model_of
from tests.solvers.constrained.element_decks import rows_of as young_rows

EXPLICIT, IMPLICIT = "explicit", "implicit"
VSDF_METHODS = {EXPLICIT: "RK45", IMPLICIT: "RAD5"}
DAFMS_METHODS = {EXPLICIT: "dop853", IMPLICIT: "sdirk4"}


def young(ball, end, step, lines, method):
    cards = (
        f"MASS 2 {ball.m} 0 0 0 {ball.J} {ball.J} {ball.J}\n"
        f"GRAVITY {' '.join(map(repr, ball.g))}\nVELOCITY 2 {' '.join(map(repr, (*ball.v, *ball.w)))}\n"
    )
    cards += f"TOLERANCE {ball.tolerance}\n" + ("RAD5\n" if method == IMPLICIT else "")
    deck = FREE.replace("0 0 0 1 0 0 0\n1 0", f"{' '.join(map(repr, ball.r))} 1 0 0 0\n1 0", 1)
    lines = lines.replace("BALL", "2(0,0,0)").replace("GROUND", "0(0,0,0)")
    return young_rows(deck, f"0 {end} {step}", f"{cards}ELEMENTS\n{lines}")


def vsdf(ball, end, step, lines, method):
    def numbers(values):
        return ",".join(map(repr, values))

    deck = (
        f"VSDF BALL\nBODY\n 1,RIGD\nRIGI\n 1,{ball.m},0,0,0\n {ball.J},{ball.J},{ball.J},0,0,0\n"
        f"NODE\n 1,1,0,0,0\nPOSI\n 1,{numbers(ball.r)}\nVELO\n 1,{numbers((*ball.v, *ball.w))}\n"
        f"GRAV\n {numbers(ball.g)}\n"
    )
    lines = lines.replace("BALL", "1:1").replace("GROUND", "0(0,0,0)")
    return vsdf_rows(deck, end, step, f"ELEMENTS\n{lines}", VSDF_METHODS[method])


def dafms(ball, end, step, lines, method):
    speeds = "".join(f"{x:10.4f}" for x in (*ball.w, *ball.v, 0.0, 0.0, 0.0, *ball.r))
    speeds = "\n".join(speeds[k : k + 50] for k in range(0, len(speeds), 50))
    deck = (
        "    1    3\nDFMB BALL\n    1    3    1    1    1\n    1    3    1    1    1\n    0\n    0\n"
        f"{round(end / step):5d}\n{step:10.5f}\nCONN\n    0\nMASS\n    1{ball.m:10.5f}\n"
        f"INER\n    1{3 * f'{ball.J:10.3E}'}\nEULT\n    1       0.0       0.0       0.0       1.0\n"
        "EULL\n    1       0.0       0.0       0.0       1.0\n"
        f"Y(L)\n{speeds}\nGRAV\n    0{''.join(f'{x:10.4f}' for x in ball.g)}\n"
        f"TOLR\n{ball.tolerance:13.3E}{ball.tolerance / 10.0:13.3E}\n"
    )
    lines = lines.replace("BALL", "1(0,0,0)").replace("GROUND", "0(0,0,0)")
    return dafms_rows(f"ELEMENTS\n{lines}", DAFMS_METHODS[method], deck)


DIALECTS = {"young": young, "vsdf": vsdf, "dafms": dafms}


def ball(r, v, w=(0.0, 0.0, 0.0), g=(0.0, 0.0, -9.81), m=0.5, radius=0.05, tolerance=1e-11, J=None):
    return SimpleNamespace(
        m=m, J=0.4 * m * radius**2 if J is None else J, r=r, v=v, w=w, g=g, tolerance=tolerance
    )


def on_plane(law, radius=0.05, normal="(0,0,1)"):
    return f"  CONTACT floor plane-sphere from=GROUND to=BALL normal={normal} radius_to={radius}\n    {law}\n"


def test_codes_are_those_of_the_kernels():
    assert CONTACT.code == kernel.CONTACT
    assert arrays.CONTACT_COLUMNS == kernel.CONTACT_COLUMNS
    names = ("PLANE_BALL", "PLANE_RIM", "CORES", "BOX_BALL", "CYLINDER_BALL", "MESH_BALL")
    assert [getattr(arrays, name) for name in names] == [getattr(contact_shapes, name) for name in names]
    assert {tuple(pair.split("-")) for pair in PAIRS} <= {(a, b) for a in OF_FIRST for b in OF_SECOND}


@pytest.mark.parametrize("method", [EXPLICIT, IMPLICIT])
@pytest.mark.parametrize("dialect", DIALECTS)
def test_one_collision_is_that_of_the_closed_form(dialect, method):
    """`reference/motion`, contact-one-collision: tolerance 1e-8, of the duration too."""
    rows = DIALECTS[dialect](
        ball((0.0, 0.0, 0.55), (0.0, 0.0, -2.0), g=(0.0, 0.0, 0.0)),
        1,
        0.001,
        on_plane("stiffness=2e6 exponent=1.5 damping=0.4"),
        method,
    )
    error, body = 1e-8, 1 if dialect == "young" else 0
    assert rows.velocity[-1, body, 2] == pytest.approx(1.29593484987, abs=error)
    assert rows.position[-1, body, 2] == pytest.approx(1.0131310401, abs=error)
    assert rows.dissipated[-1] == pytest.approx(0.580138216226, abs=error)
    during = np.flatnonzero(rows.element_effort[:, 0] > 0.0)
    assert rows.contact_changed[during[0], 0] == pytest.approx(0.25, abs=1e-12)
    assert rows.contact_changed[-1, 0] == pytest.approx(0.25 + 0.0068059727675, abs=error)
    assert rows.contact_touches[-1, 0] == 1.0
    assert rows.element_effort.min() == 0.0
    total = rows.kinetic + rows.element_energy[:, 0] + rows.dissipated
    assert total - total[0] == pytest.approx(np.zeros(len(rows.time)), abs=error)


def test_restitution_is_that_of_the_line_at_its_speed():
    """A free collision at `speed` leaves with `restitution` times it."""
    rows = young(
        ball((0.0, 0.0, 0.55), (0.0, 0.0, -2.0), g=(0.0, 0.0, 0.0)),
        1,
        0.5,
        on_plane("stiffness=1e6 exponent=1.3 restitution=0.37 speed=2"),
        EXPLICIT,
    )
    assert rows.velocity[-1, 1, 2] == pytest.approx(0.74, abs=1e-8)


def test_draw_shot_slides_returns_and_rolls():
    """`reference/motion`, contact-draw-shot."""
    radius, g = 0.0286, 9.81
    depth = 0.17 * g / 1e6
    shot = ball((0.0, 0.0, radius - depth), (1.0, 0.0, 0.0), (0.0, -120.0, 0.0), m=0.17, radius=radius,
                tolerance=1e-7)  # fmt: skip
    rows = young(
        shot, 2, 0.005, on_plane("stiffness=1e6 damping=0.05 friction=0.2 creep=1e-3", radius), IMPLICIT
    )
    places = {20: 0.09019, 40: 0.16076, 80: 0.24304, 120: 0.24684, 200: 0.142348207785, 400: -0.123937506501}
    speeds = {20: 0.8038, 40: 0.6076, 80: 0.2152, 120: -0.1772, 200: -0.266285714286, 400: -0.266285714286}
    spins = {20: -102.84965035, 40: -85.6993006993, 80: -51.3986013986, 120: -17.0979020979}
    spins |= {200: -9.31068931069, 400: -9.31068931069}
    assert {k: rows.position[k, 1, 0] for k in places} == pytest.approx(places, abs=4e-4)
    assert {k: rows.velocity[k, 1, 0] for k in speeds} == pytest.approx(speeds, abs=5e-4)
    assert {k: rows.angular_velocity[k, 1, 1] for k in spins} == pytest.approx(spins, abs=0.05)
    assert rows.velocity[-1, 1, 0] == pytest.approx(-0.266285714286, abs=3e-4)
    slip = rows.velocity[:, 1, 0] - radius * rows.angular_velocity[:, 1, 1]
    # Between rows the slip falls linearly, by 7/2 mu g t.
    k = np.argmax(slip < 10.0 * 1e-3)
    share = (slip[k - 1] - 10.0 * 1e-3) / (slip[k - 1] - slip[k])
    rolls = rows.time[k - 1] + share * (rows.time[k] - rows.time[k - 1])
    assert rolls == pytest.approx(0.645405562837, abs=0.005)
    assert rows.total - rows.total[0] == pytest.approx(np.zeros(len(rows.time)), abs=1e-5)


@pytest.mark.parametrize(
    ("slope", "places", "speeds", "spins"),
    [
        (
            20.0,
            (0.279601467169, 1.11840586868, 4.4736234747),
            (1.11840586868, 2.23681173735, 4.4736234747),
            (5.59202934337, 11.1840586867, 22.3681173735),
        ),
        (
            50.0,
            (0.702896506461, 2.81158602585, 11.2463441034),
            (2.81158602585, 5.62317205169, 11.2463441034),
            (9.45861967654, 18.9172393531, 37.8344787062),
        ),
    ],
)
def test_cylinder_on_a_slope_rolls_or_slips(slope, places, speeds, spins):
    """`reference/motion`, friction-rolling-cylinder, at 0.5, 1 and 2 s: a sphere with the inertia."""
    a, m, radius = math.radians(slope), 3.0, 0.2
    depth = m * 9.81 * math.cos(a) / 1e6
    g = (9.81 * math.sin(a), 0.0, -9.81 * math.cos(a))
    roller = ball(
        (0.0, 0.0, radius - depth), (0.0, 0.0, 0.0), g=g, m=m, J=m * radius**2 / 2.0, tolerance=1e-7
    )
    law = "stiffness=1e6 damping=0.1 friction=0.3 creep=1e-3"
    rows = young(roller, 2, 0.5, on_plane(law, radius), IMPLICIT)
    at = [1, 2, 4]
    assert rows.position[at, 1, 0] == pytest.approx(np.array(places), abs=0.002)
    assert rows.velocity[at, 1, 0] == pytest.approx(np.array(speeds), abs=0.002)
    assert rows.angular_velocity[at, 1, 1] == pytest.approx(np.array(spins), abs=0.01)


def test_a_ball_bounces_in_flights_of_the_closed_form():
    """Without damping each flight from the plane lasts 2 v/g, v² = v0² + 2 g h: the sum of energies stays."""
    bounce = ball((0.0, 0.0, 0.55), (0.0, 0.0, -2.0), tolerance=1e-10)
    rows = dafms(bounce, 1.2, 0.02, on_plane("stiffness=2e6 exponent=1.5"), EXPLICIT)
    v = math.sqrt(4.0 + 2.0 * 9.81 * 0.5)
    first = (v - 2.0) / 9.81
    changes = np.unique(rows.contact_changed[:, 0])[1:]
    assert rows.contact_touches[-1, 0] == 1.0 + (1.2 - first) // (2.0 * v / 9.81)
    assert changes[0] == pytest.approx(first, abs=1e-9)
    assert rows.kinetic.max() <= 0.5 * bounce.m * v**2 * (1.0 + 1e-3)


@pytest.mark.parametrize("height, noted", [(0.03, True), (0.06, False)])
def test_shapes_that_overlap_at_the_start_are_noted_once_with_depth_and_force(height, noted):
    """A box of edges 0.1 m, four corners 0.05 m below its centre: 1e4 N/m at 0.02 m each."""
    deck = FREE.replace("0 0 0 1 0 0 0\n1 0", f"0 0 {height} 1 0 0 0\n1 0", 1)
    box = "CONTACT box plane-box from=0(0,0,0) to=2(0,0,0) normal=(0,0,1) size_to=(0.1,0.1,0.1) stiffness=1e4"
    ball = "CONTACT far plane-sphere from=0(0,0,-1) to=2(0,0,0) normal=(0,0,1) radius_to=0.1 stiffness=1e4"
    cards = f"MASS 2 1 0 0 0 1 1 1\nELEMENTS\n  {ball}\n  {box}"
    analysis = analysis_of(model_of(deck, "0 1 1", cards))
    analysis.start()
    found = [fault for fault in analysis.warnings if "overlap" in fault.message]
    assert [(fault.subject, fault.severity) for fault in found] == noted * [("box", "note")]
    assert all("overlap by 0.02 m at the start and push with 200 N;" in fault.message for fault in found)


@pytest.mark.parametrize(("method", "noted"), [("radau", True), ("dop853", False)])
def test_methods_that_do_not_stop_for_contacts_say_so(method, noted):
    lines = "CONTACT end plane-point from=0(0,0,0) to=2(0,0,0) normal=(0,1,0) stiffness=100"
    tree = build(deck(f"ELEMENTS\n  {lines}", TWO_LINKS))[0]
    analysis = TreeAnalysis(replace(tree, integration=replace(tree.integration, method=method)))
    next(analysis.rows())
    assert ("SOLVE-232" in [fault.id for fault in analysis.warnings]) is noted


@pytest.mark.parametrize("method", [EXPLICIT, IMPLICIT])
def test_a_ball_that_spins_about_the_normal_is_braked_by_the_lever_of_torsion(method):
    """J dw/dt = -lever N, and what the spin loses is dissipated."""
    spinning = ball((0.0, 0.0, 0.05 - 5e-6), (0.0, 0.0, 0.0), (0.0, 0.0, 8.0), g=(0.0, 0.0, -10.0))
    law = "stiffness=1e6 damping=0.1 torsion=0.001 creep=1e-4"
    rows = young(spinning, 0.3, 0.05, on_plane(law), method)
    spin = rows.angular_velocity[:, 1, 2]
    assert spin == pytest.approx(8.0 - 0.001 * 5.0 / spinning.J * rows.time, abs=1e-8)
    assert rows.dissipated == pytest.approx(0.5 * spinning.J * (64.0 - spin**2), abs=1e-10)
