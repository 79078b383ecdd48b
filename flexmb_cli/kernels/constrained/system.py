"""Arguments of the kernels of constrained dynamics: the model, and arrays used again and again.

A mechanism of b bodies with E modal coordinates and m equations has n = 6 b + E speeds u: v and ω of every
body, then all η̇; its coordinates q (n + b,) are r and p of every body, then all η.
"""

from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...memory import paged_zeros
from .._jit import plain
from ..contact import CONTACT, CONTACT_COLUMNS
from ..laws import ANSWER_COLUMNS
from ..linalg.rank_revealing_lu import Factors

if TYPE_CHECKING:
    from ...model.arrays.contacts import Contacts
    from ...model.arrays.signals import Signals


class System(NamedTuple):
    """A mechanism; records are those of `model.arrays.records`."""

    constraints: np.ndarray  # CONSTRAINT records without normalisation, whose r rows come first
    bodies: np.ndarray  # (r, 2) numbers of the bodies of the two halves of each of these rows
    row_scale: np.ndarray  # (m,) units of the equations, m or 1
    speed_scale: np.ndarray  # (n,) units of the speeds, m/s or 1/s
    masses: np.ndarray  # (b,) MASS records
    flexible: np.ndarray  # FLEXIBLE records
    modal: np.ndarray  # their invariants, flat, see `mass_matrix.constants_of`
    body_vectors: np.ndarray  # BODY_VECTOR records
    shapes: np.ndarray  # their shapes S (3, N), flat, m or 1 per unit of η
    primitives: np.ndarray  # PRIMITIVE records, first those of the other m - r rows, then those of loads
    loads: np.ndarray  # LOAD records
    sensors: np.ndarray  # LOAD records of sensors
    signals: "Signals"  # what is made of them, and of elements
    functions: np.ndarray  # FUNCTION records
    knots: np.ndarray  # (k, 3) knots of their tables and pieces: s, value, second rate; see `FunctionTable`
    gravity: np.ndarray  # (3,) global axes, m/s²
    groups: np.ndarray  # GROUP records
    joint_vectors: np.ndarray  # BODY_VECTOR records of joint coordinates, which only report rows hold
    joint_coordinates: np.ndarray  # their PRIMITIVE records, whose angles stand behind all others
    contacts: "Contacts"  # of its loads


class Work(NamedTuple):
    """Arrays reused in every evaluation."""

    rotations: np.ndarray  # (3, b, 3, 3) A, dA/dt, 1/s, remainder of d²A/dt², 1/s²; rows A, RATE, REMAINDER
    rows: np.ndarray  # (3, m) in units of the equations; rows PHI, GAMMA, SCALED
    phi_q: np.ndarray  # (r, 14) derivatives by the coordinates of both bodies, in units of both
    jacobian: np.ndarray  # (m, c) its entries at the places of `columns`, in units of both
    factors: np.ndarray  # (m n,) its elimination, scaled: what remains of one row after the other
    order: np.ndarray  # (m + n,) numbers of the rows, then of the columns, in the order of elimination
    motions: np.ndarray  # (n, n) the free speeds, scaled, in its first n - rank columns
    reduced: np.ndarray  # (n, n) Cholesky factor of the mass matrix of the free speeds
    mass: np.ndarray  # (b, 6, 6) mass matrices of the rigid bodies, kg, kg m, kg m²
    modal: np.ndarray  # of the flexible bodies, flat, see `mass_matrix.places_of`
    body_vectors: np.ndarray  # (4, body vectors, 3) global axes, m; rows VECTOR, RATE, REMAINDER, TURN
    relative_vectors: np.ndarray  # (3, primitives, 2, 3) V and W of the primitives, the same rows
    angles: np.ndarray  # (angles,) expected, which decide on whole turns, rad
    vectors: np.ndarray  # (6, n + b) in units of speeds, coordinates or forces on them; rows FORCES … QD
    rank: np.ndarray  # (1,) number of independent equations in the order in use
    quality: np.ndarray  # (1,) of the order in use, no unit, see `rank_revealing_lu.factorise`
    pivots: np.ndarray  # (m,) scaled, at the end of the last step, see `singular_ahead`
    responses: (
        np.ndarray
    )  # (loads, 8; 16 with contacts) of elements, columns and SI units as in `laws`, `contact`
    columns: np.ndarray  # (m, 1 + c) number of places of a row of the Jacobian not zero, and these
    entries: np.ndarray  # (m n,) places of the factors, and
    ends: np.ndarray  # (m, 4) places where a row of them begins and ends, see `sparse_rows`
    diagonal: np.ndarray  # (m,) pivots of the elimination, scaled
    scales: np.ndarray  # (m, c) of the entries of the Jacobian: units of speeds over those of equations
    joint_vectors: np.ndarray  # (4, joint vectors, 3) global axes, m, as `body_vectors`
    joint_ends: np.ndarray  # (3, joint coordinates, 2, 3) V and W, global axes, m, as `relative_vectors`


PHI, GAMMA, SCALED = 0, 1, 2
FORCES, UNKNOWN, PRODUCT, FREE, CORRECTION, QD = 0, 1, 2, 3, 4, 5

SOLVED, SINGULAR, NO_INERTIA = 0, 1, 2


@plain
def make_work(system: System, angles: int) -> Work:
    """Work for a mechanism with `angles` angles."""
    bodies, m, n = system.masses.shape[0], system.row_scale.shape[0], system.speed_scale.shape[0]
    modal, columns = 0, columns_of(system)
    for k in range(system.flexible.shape[0]):
        N = system.flexible[k]["modes"]
        modal += 12 + 12 * N + (6 + N) * (6 + N) + 6 + N
    # Body vectors of the ground stay as they are placed: at rest.
    return Work(
        np.zeros((3, bodies, 3, 3)), np.zeros((3, m)), np.zeros((system.bodies.shape[0], 14)),
        np.zeros((m, columns.shape[1] - 1)), paged_zeros((m * n,)), np.zeros(m + n, np.int64),
        paged_zeros((n, n)), paged_zeros((n, n)), np.zeros((bodies, 6, 6)), np.zeros(modal),
        np.zeros((4, system.body_vectors.shape[0], 3)), np.zeros((3, system.primitives.shape[0], 2, 3)),
        np.zeros(angles), np.zeros((6, n + bodies)), np.zeros(1, np.int64), np.ones(1), np.zeros(m),
        np.zeros((system.loads.shape[0], _columns_of_answers(system))), columns,
        paged_zeros((m * n,), np.int64),
        np.zeros((m, 4), np.int64), np.zeros(m), _scales_of(system, columns),
        np.zeros((4, system.joint_vectors.shape[0], 3)),
        np.zeros((3, system.joint_coordinates.shape[0], 2, 3)),
    )  # fmt: skip


@plain
def _scales_of(system: System, columns: np.ndarray) -> np.ndarray:
    places = columns[:, 1:]
    scales = system.speed_scale[places] / system.row_scale[:, None]
    return np.where(np.arange(places.shape[1]) < columns[:, :1], scales, 1.0)


@plain
def _columns_of_answers(system: System) -> int:
    return CONTACT_COLUMNS if np.any(system.loads["shape"] == CONTACT) else ANSWER_COLUMNS


@plain
def factors_of(work: Work) -> Factors:
    """Return the elimination of the Jacobian: views, which follow the work."""
    return Factors(work.factors, work.entries, work.ends, work.diagonal)


@plain
def columns_of(system: System):
    """Return columns (m, 1 + c): how many of each equation's Jacobian may be other than zero, then which."""
    first, bodies = system.bodies.shape[0], system.masses.shape[0]
    of_pairs = {
        pair: _speeds_of({(body, 0, 0) for body in pair}, bodies)
        for pair in set(map(tuple, system.bodies.tolist()))
    }
    places_of_rows = [of_pairs[pair] for pair in map(tuple, system.bodies.tolist())]
    for row in range(first, system.row_scale.shape[0]):
        body_vectors: set[int] = set()
        k = row - first
        while k >= 0:
            primitive = system.primitives[k]
            body_vectors.update(map(int, primitive["ends"].ravel() if primitive["alpha"] else ()))
            body_vectors.update(int(primitive[name]) for name in ("f", "g", "h") if primitive["beta"])
            k = int(primitive["next"])
        moved = (system.body_vectors[body_vector] for body_vector in body_vectors if body_vector >= 0)
        places_of_rows.append(
            _speeds_of(
                {
                    (int(body_vector["body"]), int(body_vector["first"]), int(body_vector["modes"]))
                    for body_vector in moved
                },
                bodies,
            )
        )
    columns = np.zeros((len(places_of_rows), 1 + max(map(len, places_of_rows), default=0)), np.int64)
    for row, places in enumerate(places_of_rows):
        columns[row, 0] = len(places)
        columns[row, 1 : 1 + len(places)] = places
    return columns


@plain
def _speeds_of(parts: Iterable[tuple[int, int, int]], bodies: int) -> list[int]:
    """Sorted speeds that (body, first modal coordinate, number of modes) of some body vectors have; none at
    -1.
    """
    speeds: set[int] = set()
    for body, first, modes in parts:
        if body >= 0:
            speeds.update(range(6 * body, 6 * body + 6))
            speeds.update(range(6 * bodies + first, 6 * bodies + first + modes))
    return sorted(speeds)
