"""Moments of mass of a body given by rows of M and K: what M gives exactly, and estimates of the rest.

With N_k the displacement field of row or shape k, M gives the sums of density times N_k and x cross N_k, but
of G_k, the integral of N_k x', and of T_kl, that of N_k N_l', only parts.  Shapes are split into a rigid
motion (v, w), with which all moments are exact, and a rest without momentum P d:

- symmetric part of G: products of the rest with the linear fields L x, whose rotations and modal rows are
  those of least strain energy;
- T of the rest: by nodes, u = N u_i + rotation_i cross xi; modal rows have no place and no share.

Sources: rigid parts as in Shabana, Dynamics of Multibody Systems; the estimates are flexmb's own, see
docs/theory/vsdf.md for their errors.
"""

from dataclasses import dataclass

import numpy as np

from .invariants import EPSILON, invariants_of
from .rows import RowMatrices

# Pairs of axes of the six symmetric linear fields.
_PAIRS = [(i, j) for i in range(3) for j in range(i, 3)]


@dataclass(frozen=True)
class RigidMass:
    """Mass, kg, first moment (3,), kg m, and inertia (3, 3), kg m², about the origin, all of M's rows."""

    m: float
    s0: np.ndarray
    J0: np.ndarray

    @property
    def second(self) -> np.ndarray:
        """The integral of x x' (3, 3), kg m²."""
        return np.trace(self.J0) / 2 * np.eye(3) - self.J0


def rigid_mass(matrices: RowMatrices) -> RigidMass:
    """Mass, first moment and inertia: R' M R of the rigid rows R; its structure has been tested."""
    R = matrices.rows.rigid
    m6 = R.T @ matrices.M @ R
    skew = (m6[3:, :3] - m6[3:, :3].T) / 2
    s0 = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
    return RigidMass(float(np.trace(m6[:3, :3]) / 3), s0, (m6[3:, 3:] + m6[3:, 3:].T) / 2)


def row_invariants(matrices: RowMatrices, Phi: np.ndarray) -> dict[str, np.ndarray]:
    """The invariants (names as in `FlexibleBody`) of the shapes `Phi` (k, N), rows in the body frame."""
    R, M = matrices.rows.rigid, matrices.M
    mass, weighted = rigid_mass(matrices), M @ Phi
    motion = np.linalg.solve(R.T @ M @ R, R.T @ weighted)
    rest = Phi - R @ motion
    turned = np.einsum("abc,bk->kac", EPSILON, motion[3:])  # w~
    sums = np.vstack([mass.s0, (R[:, :3].T @ weighted).T])
    of_rigid = np.einsum("ak,b->kab", motion[:3], mass.s0) + turned @ mass.second
    of_rest = _linear_moments(matrices, rest)
    first = of_rigid + of_rest
    # Rigid part of k times all of l, and rest of k times rigid part of l.
    T = _by_nodes(matrices, rest)
    T += np.einsum("ak,lb->klab", motion[:3], sums[1:]) + np.einsum("kac,lbc->klab", turned, first)
    T += np.einsum("kac,lbc->klab", of_rest, turned)
    G = np.zeros((len(T) + 1, len(T) + 1, 3, 3))
    G[0, 0], G[1:, 0], G[0, 1:], G[1:, 1:] = mass.second, first, first.transpose(0, 2, 1), T
    return invariants_of(mass.m, sums, G) | {"Mff": Phi.T @ weighted}


def _linear_moments(matrices: RowMatrices, rest: np.ndarray) -> np.ndarray:
    """Estimates (N, 3, 3) of G, symmetric for shapes `rest` (k, N) without moment of momentum."""
    fields = _linear_fields(matrices)
    products = fields.T @ (matrices.M @ rest)
    moments = np.zeros((rest.shape[1], 3, 3))
    for (i, j), values in zip(_PAIRS, products, strict=True):
        moments[:, i, j] = moments[:, j, i] = values
    return moments


def _linear_fields(matrices: RowMatrices) -> np.ndarray:
    """Rows (k, 6) of the fields L x, L = (e_i e_j' + e_j e_i') / 2; the others by least strain."""
    rows, K = matrices.rows, matrices.K
    fields = np.zeros((len(K), len(_PAIRS)))
    for column, (i, j) in enumerate(_PAIRS):
        field = np.zeros((len(K), 3))
        field[:, i] += rows.positions[:, j] / 2
        field[:, j] += rows.positions[:, i] / 2
        fields[rows.shifting, column] = np.einsum("ka,ka->k", field, rows.directions)[rows.shifting]
    free = np.flatnonzero(~rows.shifting)
    if len(free):
        scale = matrices.scales()[free]
        inner = scale[:, None] * K[np.ix_(free, free)] * scale
        forces = scale[:, None] * (K[free] @ fields)
        # A line of nodes leaves the spin about it free: the least rotations that do.
        fields[free] = -scale[:, None] * np.linalg.lstsq(inner, forces, rcond=1e-11)[0]
    return fields


def _by_nodes(matrices: RowMatrices, shapes: np.ndarray) -> np.ndarray:
    """T (N, N, 3, 3) of `shapes` (k, N) from the blocks of M between nodes."""
    rows, M, N = matrices.rows, matrices.M, shapes.shape[1]
    shifts, turns = (np.array(list(rows.triples(first).values()), int).reshape(-1, 3) for first in (1, 4))
    T = np.zeros((N, 3, N, 3))
    along = [shapes[shifts[:, a]] for a in range(3)]
    of_axis = [M[np.ix_(shifts[:, a], shifts[:, a])] for a in range(3)]
    for a in range(3):
        for b in range(3):
            T[:, a, :, b] += along[a].T @ (of_axis[a] + of_axis[b]) @ along[b] / 2
    if len(turns):
        # Rotations as matrices (node xi, shape x): th~ xi is what they displace.
        spins = np.einsum("abc,nbk->ncka", EPSILON, shapes[turns]).reshape(3 * len(turns), 3 * N)
        spread = _second_moments(M, turns)
        T += (spins.T @ spread @ spins).reshape(N, 3, N, 3)
        arms = _first_moments(M, shifts, turns)
        for a in range(3):
            part = (along[a].T @ arms @ spins).reshape(N, N, 3)
            T[:, a] += part
            T[:, :, :, a] += part.transpose(1, 2, 0)
    return T.transpose(0, 2, 1, 3)


def _second_moments(M: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """The integrals of xi_i xi_j' of the rotations' arms xi, (3 n, 3 n)."""
    n = len(turns)
    blocks = M[np.ix_(turns.ravel(), turns.ravel())].reshape(n, 3, n, 3).transpose(0, 2, 1, 3)
    traces = np.einsum("ijaa->ij", blocks)[:, :, None, None]
    blocks_of_pairs: np.ndarray = (traces / 2 * np.eye(3) - blocks).transpose(0, 3, 1, 2)
    return blocks_of_pairs.reshape(3 * n, 3 * n)


def _first_moments(M: np.ndarray, shifts: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """The integrals of N_i xi_j, (n shifts, 3 n turns): M = -p~ between a displacement and a rotation."""
    blocks = M[np.ix_(shifts.ravel(), turns.ravel())].reshape(len(shifts), 3, len(turns), 3)
    moments: np.ndarray = np.einsum("cab,iajb->ijc", EPSILON, blocks) / 2
    return moments.reshape(len(shifts), 3 * len(turns))
