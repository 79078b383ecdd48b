"""Every pair of shapes: the rate of the gap is its derivative, by differences of a random motion."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flexmb_cli.kernels.contact import answer_touch
from flexmb_cli.model.arrays.contacts import END, ContactTable, fill_contact, touch_records
from flexmb_cli.model.arrays.records import LAW
from flexmb_cli.model.arrays.signals import signal_arrays
from flexmb_cli.model.laws import CONTACT, PAIRS, Element, Touch

STEP = 1e-6  # s
SIGNALS = signal_arrays(())
NORMAL = (0.6, 0.0, 0.8)
SHAPES = {"axis": (0.2, 0.3, -0.1), "radius": 0.15, "size": (0.3, 0.4, 0.5)}
KEYS = {"sphere": ["radius"], "capsule": ["axis", "radius"], "cylinder": ["axis", "radius"], "box": ["size"]}


def records_of(pair):
    first, second = pair.split("-")
    given = {f"{key}_i": SHAPES[key] for key in KEYS.get(first, ())}
    given |= {f"{key}_j": SHAPES[key] for key in KEYS.get(second, ())}
    if first == "plane":
        given["axis_i"] = NORMAL
    if second == "mesh":
        given["corners"] = np.random.default_rng(3).normal(size=(5, 3))
    touch = Touch(0, 1, None, None, first, second, **given)
    item = Element("touch", CONTACT, touch, CONTACT.values(stiffness=1e3, friction=0.3, rolling=0.01))
    return fill_contact(np.zeros((), LAW), item)["c"], touch_records(touch)


def motion(rng):
    """The ends of two moving bodies at t."""
    starts, speeds, spins = 0.6 * rng.normal(size=(2, 3)), rng.normal(size=(2, 3)), rng.normal(size=(2, 3))
    attitudes = [Rotation.random(random_state=rng) for _ in range(2)]

    def at(t):
        ends = np.zeros(2, END)
        ends["position"], ends["velocity"], ends["angular"] = starts + t * speeds, speeds, spins
        turned = [Rotation.from_rotvec(t * w) * R for w, R in zip(spins, attitudes, strict=True)]
        ends["axes"] = [R.as_matrix().T.ravel() for R in turned]
        return ends

    return at


@pytest.mark.parametrize("pair", PAIRS)
def test_the_rate_of_a_gap_is_its_derivative(pair):
    rng = np.random.default_rng(7)
    c, records = records_of(pair)
    table = ContactTable()
    table.mesh(np.random.default_rng(4).normal(size=(6, 9)))
    contacts = table.arrays()
    for record in records:
        for _ in range(6):
            at, answers = motion(rng), np.repeat(record, 3)
            for t, answer in zip((-STEP, 0.0, STEP), answers, strict=True):
                answer_touch(c, answer, contacts, SIGNALS, *at(t))
            slope = (answers["gap"][2] - answers["gap"][0]) / (2.0 * STEP)
            assert answers["rate"][1] == pytest.approx(slope, abs=1e-7)
