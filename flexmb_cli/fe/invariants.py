"""Inertia invariants of a modal basis, from products with the n x n matrix of scalar masses.

Vlasenko and Kasper (2008): m (36), s0 and S1 (40), J (48), C (46), with q_f = Phi eta put in.
With S^ij = m_ij E every product of skew-symmetric stacks is one of G = P' m Q (3 x 3):
P~' S Q~ = tr(G) E - G', and (P~' S q)_a = -eps_abc G_bc.
"""

import numpy as np

EPSILON = np.zeros((3, 3, 3))
EPSILON[[0, 1, 2], [1, 2, 0], [2, 0, 1]] = 1.0
EPSILON[[0, 2, 1], [2, 1, 0], [1, 0, 2]] = -1.0


def inertia_invariants(r0: np.ndarray, Phi: np.ndarray, mass: np.ndarray) -> dict[str, np.ndarray]:
    """The invariants m, s0, S1, J0, J1, J2, C0, C1, Mff of nodes `r0` (n, 3) and modes `Phi` (3 n, N).

    `mass` is the matrix m (n, n); names and shapes as in `FlexibleBody`.
    """
    n, N = len(r0), Phi.shape[1]
    U = np.hstack([r0, Phi.reshape(n, 3, N).transpose(0, 2, 1).reshape(n, 3 * N)])
    weighted = mass @ U
    # Block (k, l) of the products is G of shapes k and l; shape 0 is r0.
    G = (U.T @ weighted).reshape(N + 1, 3, N + 1, 3).transpose(0, 2, 1, 3)
    sums = weighted.sum(axis=0).reshape(N + 1, 3)
    return invariants_of(float(mass.sum()), sums, G)


def invariants_of(m: float, sums: np.ndarray, G: np.ndarray) -> dict[str, np.ndarray]:
    """The invariants of a body of mass `m`, from first and second moments of its N shapes; shape 0 is x.

    `sums` (N + 1, 3): integrals of density times shape k; `G` (N + 1, N + 1, 3, 3): of shape k times shape l.
    """
    # P_k~' S P_l~ (…, 3, 3) and P_k~' S phi_l (…, 3) for all pairs.
    J = np.einsum("klaa->kl", G)[:, :, None, None] * np.eye(3) - G.transpose(0, 1, 3, 2)
    C = -np.einsum("abc,klbc->kla", EPSILON, G)
    return {
        "m": m,
        "s0": sums[0],
        "S1": sums[1:].T.copy(),
        "J0": J[0, 0],
        "J1": J[1:, 0] + J[0, 1:],
        "J2": J[1:, 1:].copy(),
        "C0": C[0, 1:].T.copy(),
        "C1": C[1:, 1:].transpose(0, 2, 1).copy(),
        "Mff": np.einsum("klaa->kl", G[1:, 1:]),
    }


def effective_masses(S1: np.ndarray, C0: np.ndarray) -> np.ndarray:
    """Mass that each mode of unit modal mass moves along, and inertia about, the body's axes, (N, 6).

    Translation along e_a takes 1' S phi, rotation about it (e_a~ r0)' S phi = -(R0' S phi)_a.
    """
    return np.vstack([S1, C0]).T ** 2
