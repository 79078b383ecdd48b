"""The stiff part of a tree's equations, b y' = ... - D y - K q, and linear systems with b + f D + f² K.

K and D hold elastic bodies, their stiffening and elements; what else depends on the coordinates
is soft, and an implicit step may leave it out of its matrix.  All matrices are stored by profiles
(`profile_elimination`): rows of K end where `tree.reach` says, those of b at what moves along, so
that for slender bodies factors and products cost as much as there are nodes.

Closed loops add J x = J r to such a system, and unknown forces along the rows of J.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .._jit import kernel
from ..linalg.number_rows import copy, product, subtract_multiple
from ..linalg.profile_ldl import factorise_profile, set_profile_times, substitute_profile
from ..linalg.vec3 import cross, minus, scaled, triple
from .composite_mass import add_generalised_forces, set_mass
from .element_rows import set_element_rows
from .loads import axial_prestress
from .loop_closures import TURN_ROW, eliminate_rows, solve_rows

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


class Stiff(NamedTuple):
    """b, K and the factors, of NS speeds and R closed directions, and work space."""

    mass: np.ndarray  # (NS, NS) b, kg, kg m, kg m², with the places that the one-way assumption leaves out
    stiff: np.ndarray  # (NS, NS) K, N/m, N, N m
    matrix: np.ndarray  # (NS, NS) factors, in the units of b
    mass_ends: np.ndarray  # (NS,) number of one past the last place of a row
    stiff_ends: np.ndarray  # (NS,) the same numbers of K
    matrix_ends: np.ndarray  # (NS,) the same of the factors
    rest: np.ndarray  # (NS,) a right-hand side's rigid part, in units of coordinates
    rows: np.ndarray  # (R,) CLOSURE_ROW records: the closures as they were for the matrix, and their forces
    jacobian: np.ndarray  # (R, NS) J
    inverse_jacobian: np.ndarray  # (R, NS) rows of (b + f D + f² K)^-1 Jᵀ
    schur: np.ndarray  # (R, R) J times these
    element_rows: np.ndarray  # (E + m + 3 T, NS) what coordinates feel of a unit effort, 1, m
    element_slopes: np.ndarray  # (E + m + 3 T, 2) -dF/dx and -dF/dv, N/m, N s/m, or of torques and turns


def stiff_work(closures: np.ndarray, speeds: int, elements: int) -> Stiff:
    """Return blank work space for `speeds` coordinates and closures (R,)."""
    rows = closures.size
    return Stiff(  # type: ignore[call-arg]
        *(np.zeros((speeds, speeds)) for _ in range(3)),
        *(np.zeros(speeds, np.int64) for _ in range(3)),
        np.zeros(speeds),
        closures.copy(),
        np.zeros((rows, speeds)),
        np.zeros((rows, speeds)),
        np.zeros((rows, rows)),
        np.zeros((elements, speeds)),
        np.zeros((elements, 2)),
    )


@kernel
def renew(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, z: np.ndarray, s: Stiff) -> None:
    """Fill b, K and J at the state z."""
    set_mass(tree, work, coordinates, z, s.mass)
    _set_ends(s.mass, s.mass_ends)
    _set_stiffness(tree, work, s.stiff, s.stiff_ends)
    set_jacobian(tree, work, coordinates, s)
    set_element_rows(tree, work, coordinates, z, s.element_rows, s.element_slopes)
    _add_element_stiffness(s)


@kernel
def _add_element_stiffness(s: Stiff) -> None:
    """K += k g gᵀ of every element, whose row of K ends at the last coordinate that feels it."""
    n = s.stiff.shape[0]
    for e in range(s.element_rows.shape[0]):
        row, end = s.element_rows[e], n
        if s.element_slopes[e, 0] == 0.0 and s.element_slopes[e, 1] == 0.0:
            continue
        while end > 0 and row[end - 1] == 0.0:
            end -= 1
        for i in range(end):
            if row[i] != 0.0:
                s.stiff_ends[i] = max(s.stiff_ends[i], end)
                for j in range(i, end):
                    s.stiff[i, j] += s.element_slopes[e, 0] * row[i] * row[j]


@kernel
def _add_element_damping(tree: "TreeArrays", factor: float, s: Stiff) -> None:
    """Matrix += factor d g gᵀ of every element."""
    for e in range(s.element_rows.shape[0]):
        row = s.element_rows[e]
        if s.element_slopes[e, 1] == 0.0:
            continue
        for i in range(row.shape[0]):
            if row[i] != 0.0:
                for j in range(i, s.stiff_ends[i]):
                    if not (tree.one_way and tree.elastic[i] != tree.elastic[j]):
                        s.matrix[i, j] += factor * s.element_slopes[e, 1] * row[i] * row[j]


@kernel
def set_jacobian(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, s: Stiff) -> None:
    """Fill J for placed frames and measured closures."""
    for i in range(s.rows.shape[0]):
        s.rows[i] = tree.closures[i]
        s.jacobian[i].fill(0.0)
        if s.rows[i]["coupling"] >= 0:
            copy(tree.couplings[s.rows[i]["coupling"]], s.jacobian[i])
        row, direction = s.rows[i], triple(s.rows[i]["direction"], 0)
        _add_force_row(tree, work, coordinates, row, row["frame_a"], direction, s.jacobian[i])
        _add_force_row(tree, work, coordinates, row, row["frame_b"], scaled(-1.0, direction), s.jacobian[i])
        for m in range(s.jacobian.shape[1]):
            if tree.given[m]:
                s.jacobian[i, m] = 0.0


@kernel
def _add_force_row(
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
    row: np.void,
    k: int,
    force: tuple[float, float, float],
    jacobian: np.ndarray,
) -> None:
    """Add what the coordinates feel of a force on frame k at the place of a closure, or of a torque."""
    if row["type"] == TURN_ROW:
        add_generalised_forces(tree, work, coordinates, k, force, (0.0, 0.0, 0.0), jacobian)
        return
    arm = minus(triple(row["place"], 0), triple(work[k]["position"], 0))
    add_generalised_forces(tree, work, coordinates, k, cross(arm, force), force, jacobian)


@kernel
def _set_ends(A: np.ndarray, ends: np.ndarray) -> None:
    n = A.shape[0]
    for i in range(n):
        end = n
        while end > i + 1 and A[i, end - 1] == 0.0:
            end -= 1
        ends[i] = end


@kernel
def factorise(tree: "TreeArrays", f: float, s: Stiff) -> bool:
    """Factors of b + f D + f² K, and of J (b + f D + f² K)^-1 Jᵀ; False when it is not positive definite."""
    A, n = s.matrix, s.matrix.shape[0]
    for i in range(n):
        s.matrix_ends[i] = max(s.mass_ends[i], s.stiff_ends[i])
        for j in range(i, s.matrix_ends[i]):
            A[i, j] = s.mass[i, j] + f * f * s.stiff[i, j]
            if tree.one_way and tree.elastic[i] != tree.elastic[j]:
                A[i, j] = 0.0
    _add_damping(tree, f, A)
    _add_element_damping(tree, f, s)
    if not factorise_profile(A, s.matrix_ends):
        return False
    factor_schur_complement(s)
    return True


@kernel
def factor_schur_complement(s: Stiff) -> None:
    """Fill (b + f D + f² K)^-1 Jᵀ and J times that, and eliminate the latter."""
    rows = s.rows.shape[0]
    for i in range(rows):
        for m in range(s.inverse_jacobian.shape[1]):
            s.inverse_jacobian[i, m] = s.jacobian[i, m]
        substitute_profile(s.matrix, s.matrix_ends, s.inverse_jacobian[i])
        for j in range(rows):
            s.schur[j, i] = product(s.jacobian[j], s.inverse_jacobian[i])
    eliminate_rows(s.rows, s.schur)


@kernel
def set_mass_times(tree: "TreeArrays", x: np.ndarray, s: Stiff, out: np.ndarray) -> None:
    """out = b x, the one-way assumption respected."""
    set_profile_times(s.mass, s.mass_ends, x, out)
    if tree.one_way:
        for i in range(x.shape[0]):
            s.rest[i] = x[i] if tree.elastic[i] else 0.0
        _leave_rigid_rows(tree, s, out)


@kernel
def _leave_rigid_rows(tree: "TreeArrays", s: Stiff, out: np.ndarray) -> None:
    """Take b rest off the rigid rows of out."""
    for i in range(out.shape[0]):
        if not tree.elastic[i]:
            for j in range(i, s.mass_ends[i]):
                out[i] -= s.mass[i, j] * s.rest[j]


@kernel
def solve_stiff(tree: "TreeArrays", residual: np.ndarray, x: np.ndarray, s: Stiff) -> None:
    """Replace a right-hand side x (NS,) by the solution; with closed loops, by that with J x = J residual."""
    substitute_profile(s.matrix, s.matrix_ends, x)
    if tree.one_way:
        _answer_rigid_motion(tree, x, s)
    for i in range(s.rows.shape[0]):
        s.rows[i]["force"] = product(s.jacobian[i], x) - product(s.jacobian[i], residual)
    apply_multipliers(x, s)


@kernel
def apply_multipliers(x: np.ndarray, s: Stiff) -> None:
    """Take off x (NS,) the motion that changes the gaps by what the rows hold as forces."""
    solve_rows(s.rows, s.schur)
    for i in range(s.rows.shape[0]):
        subtract_multiple(s.rows[i]["force"], s.inverse_jacobian[i], x)


@kernel
def _answer_rigid_motion(tree: "TreeArrays", x: np.ndarray, s: Stiff) -> None:
    """The elastic part of x without the coupling, less what the rigid part does to it."""
    for j in range(x.shape[0]):
        s.rest[j] = 0.0
    for i in range(x.shape[0]):
        if not tree.elastic[i]:
            for j in range(i + 1, s.mass_ends[i]):
                if tree.elastic[j]:
                    s.rest[j] += s.mass[i, j] * x[i]
    substitute_profile(s.matrix, s.matrix_ends, s.rest)
    for j in range(x.shape[0]):
        x[j] -= s.rest[j]


@kernel
def _set_stiffness(tree: "TreeArrays", work: np.ndarray, K: np.ndarray, ends: np.ndarray) -> None:
    """Fill the upper triangle of K (NS, NS) and the ends of its rows for placed frames."""
    K.fill(0.0)
    for i in range(ends.shape[0]):
        ends[i] = i + 1
    for b in range(tree.elastic_bodies.shape[0]):
        body = tree.elastic_bodies[b]
        for m in range(body["first"], body["first"] + body["count"]):
            ends[m] = body["first"] + tree.reach[m, 1]
        _add_block(1.0, tree.stiffness, body["stiffness"], body, tree.reach, K)
        if body["stiffening"] >= 0:
            turning, weight = axial_prestress(tree, work, body)
            start = body["stiffening"]
            _add_block(turning, tree.stiffening, start, body, tree.reach, K)
            _add_block(weight, tree.stiffening, start + body["count"] ** 2, body, tree.reach, K)


@kernel
def _add_damping(tree: "TreeArrays", factor: float, A: np.ndarray) -> None:
    """A += factor D."""
    for b in range(tree.elastic_bodies.shape[0]):
        body = tree.elastic_bodies[b]
        if body["damping"] >= 0:
            _add_block(factor, tree.damping, body["damping"], body, tree.reach, A)


@kernel
def _add_block(
    factor: float, matrices: np.ndarray, start: int, body: np.void, reach: np.ndarray, A: np.ndarray
) -> None:
    first, count = body["first"], body["count"]
    for i in range(count):
        for j in range(i, reach[first + i, 1]):
            A[first + i, first + j] += factor * matrices[start + i * count + j]
