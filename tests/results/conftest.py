"""The deck IN2-1-1 of the YOUNG dissertation and its motion in closed form, made by hand."""

from dataclasses import fields

import numpy as np
import pytest

from flexmb_cli.deck.record import Deck, DeckText, Number, Record
from flexmb_cli.model.mechanism import Body, Driver, Ground, Joint, Mechanism, Point, Simplified, TimeGrid
from flexmb_cli.solvers.kinematics.rows import Rows

COUNTS = ("NBODY", "NDRIVE", "NPOINT", "NSPHER", "NUNIVE", "NREVOL")
COUNTS += ("NCYLIN", "NTRANS", "NSCREW", "NSIMPL", "NSIMP2", "NGROUN")
SPEED = 1.047  # rad/s, about y: the driver of IN2-1-1


def record(section, number, **values):
    numbers = tuple(Number(key, value, key) for key, value in values.items())
    return Record(section, number, f"{section} {number}", numbers)


def vector(name, x, y, z):
    return {f"{name}.{axis}": value for axis, value in zip("xyz", (x, y, z), strict=True)}


def body(number, *values):
    keys = ("x", "y", "z", "e0", "e1", "e2", "e3")
    return record("body", number, **dict(zip(keys, values, strict=True)))


def counts(**given):
    return record("counts", 0, **{key: given.get(key, 0) for key in COUNTS})


def pack(deck_name, records):
    return Deck("young", DeckText(deck_name, "2 1 1 1 0 0 0 0 0 2 0 1\n", "0" * 64), tuple(records))


@pytest.fixture
def deck():
    return pack(
        "IN2-1-1.dat",
        [
            counts(NBODY=2, NDRIVE=1, NPOINT=1, NSPHER=1, NSIMPL=2, NGROUN=1),
            body(1, 0, 0, 0, 1, 0, 0, 0),
            body(2, 1, 0, 0, 1, 0, 0, 0),
            record("driver", 1, body=2, direction=5, C=0, B=SPEED, A=0),
            record("point", 1, body=2, x=1, y=0, z=0),
            record("spherical", 1, I=1, J=2, **vector("P_i", 0, 0, 0), **vector("P_j", -1, 0, 0)),
            record("simplified", 1, body=2, direction=4, value=0),
            record("simplified", 2, body=2, direction=6, value=0),
            record("ground", 1, body=1, x=0, y=0, z=0, alpha=0, beta=0, gamma=0),
            record("time", 0, start=0, end=6, step=1),
        ],
    )


@pytest.fixture
def mechanism():
    upright = (1.0, 0.0, 0.0, 0.0)
    return Mechanism(
        bodies=(Body("body 1", (0, 0, 0), upright), Body("body 2", (1, 0, 0), upright)),
        time=TimeGrid(0, 6, 1),
        joints=(Joint("spherical", "spherical 1", 0, 1, (0, 0, 0), (-1, 0, 0)),),
        simplified=(Simplified("simplified 1", 1, 4, 0), Simplified("simplified 2", 1, 6, 0)),
        drivers=(Driver("driver 1", 1, 5, 0, SPEED, 0),),
        grounds=(Ground("ground 1", 0, (0, 0, 0, 0, 0, 0)),),
        points=(Point("point 1", 1, (1, 0, 0)),),
    )


def turning_rows(time, coordinates=0):
    """Body 1 at rest; body 2, one unit from the origin, turns about y at SPEED; the point is at two units.

    All `coordinates` of joints are 0.
    """
    time = np.asarray(time, dtype=float)
    angle, zero, one = SPEED * time, 0 * time, 1 + 0 * time
    radius = stack(np.cos(angle), zero, -np.sin(angle))
    tangent = SPEED * stack(-np.sin(angle), zero, -np.cos(angle))
    half, rate = angle / 2, SPEED / 2
    p = stack(np.cos(half), zero, np.sin(half), zero)
    dp = rate * stack(-np.sin(half), zero, np.cos(half), zero)
    still, upright = stack(zero, zero, zero), stack(one, zero, zero, zero)
    return Rows(
        time=time,
        position=pair(still, radius),
        euler_parameters=pair(upright, p),
        velocity=pair(still, tangent),
        euler_parameter_rates=pair(0 * p, dp),
        acceleration=pair(still, -(SPEED**2) * radius),
        euler_parameter_accelerations=pair(0 * p, -(rate**2) * p),
        angular_velocity=pair(still, SPEED * stack(zero, one, zero)),
        angular_acceleration=pair(still, still),
        point_position=2 * radius[:, None],
        point_velocity=2 * tangent[:, None],
        point_acceleration=-2 * SPEED**2 * radius[:, None],
        joint_coordinate=np.zeros((len(time), coordinates)),
        joint_rate=np.zeros((len(time), coordinates)),
        constraint_residual=zero,
        velocity_residual=zero,
        newton_iterations=np.full(len(time), 3),
    )


def stack(*columns):
    return np.stack(columns, axis=1)


def pair(first, second):
    return np.stack([first, second], axis=1)


@pytest.fixture
def rows():
    return turning_rows


@pytest.fixture
def cut():
    """Rows start..stop of a block."""

    def slice_of(rows, start, stop):
        return Rows(**{f.name: getattr(rows, f.name)[start:stop] for f in fields(Rows)})

    return slice_of


@pytest.fixture
def make():
    """The builders of records, for decks of other kinds."""

    class Make:
        record, vector, body, counts, pack = map(staticmethod, (record, vector, body, counts, pack))

    return Make
