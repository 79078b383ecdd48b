"""Random mechanisms built from a known motion (known_motion.py) are found to move so.

The motion is known in closed form at 1281 times; every 64th is a report time.  Velocities and
accelerations are eighth-order differences of it, good to 1e-9 and 1e-8 at this step.
"""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.model.mechanism import Ground, Mechanism
from tests.solvers.kinematics.geometry import Gaps, axes, euler_parameters, product
from tests.solvers.kinematics.known_motion import END, EVERY, FINE, WAYS, random_motions
from tests.solvers.kinematics.solved import coordinates, mechanism_of, solved
from tests.solvers.kinematics.test_finite_differences import FIRST, SECOND

# Where kernels are interpreted a few of all sizes will do: they are slow there.
FEW = 8
SEEDS = range(36)


def case(seed):
    motions = random_motions(seed, bodies=2 + seed % 6)
    known = np.concatenate([np.stack(motions.r, 1), np.stack(motions.p, 1)], axis=2)
    return motions.mechanism(), known


def marked(seeds):
    return [pytest.param(s, marks=pytest.mark.long_motion if s >= FEW else ()) for s in seeds]


WITHOUT_SCREWS = [s for s in SEEDS if all(joint.kind != "screw" for joint in case(s)[0].joints)]


@pytest.mark.parametrize("seed", marked(SEEDS))
def test_a_known_motion_is_recovered(seed):
    mechanism, known = case(seed)
    rows = solved(mechanism)
    size = np.max(np.abs(known))
    assert np.max(np.abs(coordinates(rows) - known[::EVERY])) <= 1e-11 * size
    for order, weights, allowed in ((1, FIRST, 1e-9), (2, SECOND, 1e-8)):
        step = END / (FINE - 1)
        last = FINE - 8
        expected = sum(w * known[k : k + last] for k, w in enumerate(weights)) / step**order
        at_rows = expected[EVERY - 4 :: EVERY]
        found = coordinates(rows, order)[1 : 1 + len(at_rows)]
        assert np.max(np.abs(found - at_rows)) <= allowed * np.max(np.abs(expected))


@pytest.mark.parametrize("seed", marked(SEEDS))
def test_constraints_and_their_rates_are_met(seed):
    mechanism, _ = case(seed)
    rows, gaps = solved(mechanism), Gaps(mechanism)
    assert gaps.largest(coordinates(rows), rows.time) <= 1e-12
    rate = gaps.largest_rate(coordinates(rows), coordinates(rows, 1), rows.time)
    assert rate <= 1e-12 * (1.0 + np.max(np.abs(coordinates(rows, 1))))


@pytest.mark.parametrize("seed", marked(WITHOUT_SCREWS))
def test_estimates_a_little_off_give_the_same_motion(seed):
    """Screws are left out: the estimates are the zero of their thread."""
    mechanism, known = case(seed)
    random = np.random.default_rng(seed)
    bodies = tuple(
        replace(b, r=tuple(b.r + random.normal(0.0, 0.01, 3)), p=tuple(b.p + random.normal(0.0, 0.01, 4)))
        for b in mechanism.bodies
    )
    rows = solved(replace(mechanism, bodies=bodies))
    assert np.max(np.abs(coordinates(rows) - known[::EVERY])) <= 1e-11 * np.max(np.abs(known))


@pytest.mark.long_motion
@pytest.mark.parametrize("seed", marked(SEEDS[::2]))
def test_the_order_of_bodies_and_joints_does_not_matter(seed):
    mechanism, _ = case(seed)
    order = np.random.default_rng(seed).permutation(len(mechanism.bodies))
    rows, other = solved(mechanism), solved(renumbered(mechanism, order))
    for derivative in range(3):
        expected = coordinates(rows, derivative)[:, order]
        found = coordinates(other, derivative)
        assert np.max(np.abs(found - expected)) <= 1e-10 * (1.0 + np.max(np.abs(expected)))


def renumbered(m: Mechanism, order) -> Mechanism:
    """The mechanism whose k-th body is the order[k]-th of m, its joints in reverse order."""
    new = {int(old): k for k, old in enumerate(order)}
    return Mechanism(
        tuple(m.bodies[old] for old in order),
        m.time,
        tuple(replace(x, i=new[x.i], j=new[x.j]) for x in reversed(m.joints)),
        tuple(replace(x, body=new[x.body]) for x in reversed(m.simplified)),
        tuple(replace(x, i=new[x.i], j=new[x.j]) for x in m.distances),
        tuple(replace(x, body=new[x.body]) for x in m.drivers),
        tuple(replace(x, body=new[x.body]) for x in m.grounds),
    )


@pytest.mark.long_motion
@pytest.mark.parametrize("seed", marked(SEEDS[::2]))
def test_the_names_of_the_axes_do_not_matter(seed):
    """x, y, z renamed y, z, x, in space and in every body: coordinates are renamed and nothing else."""
    mechanism, _ = case(seed)
    rows, other = solved(mechanism), solved(with_axes_renamed(mechanism))
    places = [2, 0, 1, 3, 6, 4, 5]  # of z, x, y and e0, e3, e1, e2
    for derivative in range(3):
        expected = coordinates(rows, derivative)[:, :, places]
        found = coordinates(other, derivative)
        assert np.max(np.abs(found - expected)) <= 1e-10 * (1.0 + np.max(np.abs(expected)))


def with_axes_renamed(m: Mechanism) -> Mechanism:
    def turned(v):
        return (v[2], v[0], v[1])

    def renamed(item):
        block = 3 * ((item.direction - 1) // 3)
        return replace(item, direction=block + item.direction % 3 + 1)

    vectors = ("P_i", "P_j", "s_i", "s_j", "h_i", "h_j")
    return replace(
        m,
        bodies=tuple(replace(b, r=turned(b.r), p=(b.p[0], *turned(b.p[1:]))) for b in m.bodies),
        joints=tuple(replace(j, **{name: turned(getattr(j, name)) for name in vectors}) for j in m.joints),
        simplified=tuple(map(renamed, m.simplified)),
        distances=tuple(map(renamed, m.distances)),
        drivers=tuple(map(renamed, m.drivers)),
    )


@pytest.mark.parametrize("angle", [0.4, -2.0, np.pi])
def test_the_four_bar_turned_and_shifted_as_a_whole_moves_the_same_within_itself(angle):
    """About x, the axis of its driver; the ground body is held at the angle, the law begins there."""
    mechanism, shift = mechanism_of("IN4-BAR"), np.array([30.0, -7.0, 11.0])
    turn = euler_parameters((1.0, 0.0, 0.0), angle)
    A = axes(turn)
    bodies = tuple(
        replace(b, r=tuple(A @ b.r + shift), p=tuple(product(turn, np.array(b.p)))) for b in mechanism.bodies
    )
    whole = replace(
        mechanism,
        bodies=bodies,
        simplified=tuple(replace(s, value=shift[s.direction - 1]) for s in mechanism.simplified),
        drivers=tuple(replace(d, C=d.C + angle) for d in mechanism.drivers),
        grounds=(Ground("ground 1", mechanism.grounds[0].body, (*shift, angle, 0.0, 0.0)),),
    )
    rows, moved = solved(mechanism), solved(whole)
    assert np.max(np.abs(moved.position - (rows.position @ A.T + shift))) <= 1e-12
    assert np.max(np.abs(axes(moved.euler_parameters) - A @ axes(rows.euler_parameters))) <= 1e-12
    size = np.max(np.abs(rows.acceleration))
    assert np.max(np.abs(moved.acceleration - rows.acceleration @ A.T)) <= 1e-11 * size
    assert np.max(np.abs(moved.angular_velocity - rows.angular_velocity @ A.T)) <= 1e-11 * size


def test_the_random_mechanisms_hold_every_kind_of_constraint():
    mechanisms = [case(seed)[0] for seed in SEEDS]
    kinds = {joint.kind for m in mechanisms for joint in m.joints}
    assert kinds == {"spherical", "universal", "revolute", "cylindrical", "translational", "screw"}
    for group in ("simplified", "distances", "drivers"):
        assert {item.direction for m in mechanisms for item in getattr(m, group)} == {1, 2, 3, 4, 5, 6}
    assert len(SEEDS) >= 2 * len(WAYS)
