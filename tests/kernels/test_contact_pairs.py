"""Every pair of shapes: the rate of the gap is its derivative, by differences of a random motion."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flexmb_cli.kernels.contact import CONTACT_COLUMNS, COORDINATE, SPEED, answer_contact
from flexmb_cli.model.arrays.contacts import fill_contact
from flexmb_cli.model.arrays.records import LAW, TOUCH
from flexmb_cli.model.laws import CONTACT, PAIRS, Element, Touch

STEP = 1e-6  # s
NORMAL = (0.6, 0.0, 0.8)
SHAPES = {"axis": (0.2, 0.3, -0.1), "radius": 0.15, "size": (0.3, 0.4, 0.5)}
KEYS = {"sphere": ["radius"], "capsule": ["axis", "radius"], "cylinder": ["axis", "radius"], "box": ["size"]}


def records_of(pair):
    first, second = pair.split("-")
    given = {f"{key}_i": SHAPES[key] for key in KEYS.get(first, ())}
    given |= {f"{key}_j": SHAPES[key] for key in KEYS.get(second, ())}
    if first == "plane":
        given["axis_i"] = NORMAL
    touch = Touch(0, 1, None, None, first, second, **given)
    item = Element("touch", CONTACT, touch, CONTACT.values(stiffness=1e3, friction=0.3, rolling=0.01))
    return fill_contact(np.zeros(touch.parts, np.dtype([*LAW.descr, *TOUCH.descr])), item)


def motion(rng):
    """Two bodies at t: d, v, axes and angular velocities of i, then of j."""
    d, v = 0.9 * rng.normal(size=3), rng.normal(size=3)
    first, spins = [Rotation.random(random_state=rng) for _ in range(2)], rng.normal(size=(2, 3))

    def at(t):
        turned = [(Rotation.from_rotvec(t * w) * R).as_matrix() for w, R in zip(spins, first, strict=True)]
        axes = [tuple(tuple(A[:, k]) for k in range(3)) for A in turned]
        return tuple(d + t * v), tuple(v), axes[0], tuple(spins[0]), axes[1], tuple(spins[1])

    return at


@pytest.mark.parametrize("pair", PAIRS)
def test_the_rate_of_a_gap_is_its_derivative(pair):
    rng = np.random.default_rng(7)
    for record in records_of(pair):
        for _ in range(6):
            at = motion(rng)
            answers = np.zeros((3, CONTACT_COLUMNS))
            for t, answer in zip((-STEP, 0.0, STEP), answers, strict=True):
                answer_contact(record, *at(t), answer)
            slope = (answers[2, COORDINATE] - answers[0, COORDINATE]) / (2.0 * STEP)
            assert answers[1, SPEED] == pytest.approx(slope, abs=1e-7)
