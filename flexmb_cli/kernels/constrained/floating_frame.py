"""Inertia, quadratic velocity forces, gravity and elastic forces of one flexible body, in (ṙ, ω, η̇).

Vlasenko and Kasper (2008), (55), (74)-(77), (98), in body axes and with the invariants of a modal basis
(names as in `model.flexible_body`).  In (76) and (77) the sign of S_tf q̇f is minus, as (46) and (49) ask:
with the plus that is printed, energy and angular momentum are not conserved.  Nothing here has the
length of the finite-element model.

Arrays for N modes, in body axes (η in units of the modes, so that S1 η is in kg m):

- A (3, 3): body to global axes; w (3,): ω, rad/s; eta (N,), etad (N,): η and η̇
- s0 (3,), S1 (3, N): first moment, kg m, and its derivative by η; s (3,): first moment at η
- J0 (3, 3), J1 (N, 3, 3), J2 (N, N, 3, 3): inertia, kg m², its terms linear and quadratic in η
- C0 (3, N), C1 (N, 3, N): coupling of rotation and modes, its terms linear in η
- T (N, 3, 3), S_tt (3, 3), S_tf (3, N): what `moving_inertia` makes of these at η
- Mff (N, N), Kr (N, N), Dr (N, N): mass, stiffness and damping of the modes: ½ η̇ᵀ Mff η̇ and ½ ηᵀ Kr η are
  in J, η̇ᵀ Dr η̇ in W
- f (6 + N,): forces on (ṙ, ω, η̇), N in global axes, N m in body axes, then those on the modes
"""

import numpy as np

from .._jit import kernel


@kernel
def moving_inertia(
    eta: np.ndarray,
    J0: np.ndarray,
    J1: np.ndarray,
    J2: np.ndarray,
    C0: np.ndarray,
    C1: np.ndarray,
    T: np.ndarray,
    S_tt: np.ndarray,
    S_tf: np.ndarray,
) -> None:
    """Fill T (N, 3, 3), S_tt (3, 3) and S_tf (3, N) at the modal coordinates eta (N,).

    T_k = sum_l eta_l J2_kl is all that the rates and forces need of J2.
    """
    N = eta.shape[0]
    for a in range(3):
        for b in range(3):
            S_tt[a, b] = J0[a, b]
        for l in range(N):
            S_tf[a, l] = C0[a, l]
    for k in range(N):
        _turned_inertia(eta, J2[k], T[k])
        for a in range(3):
            for b in range(3):
                S_tt[a, b] += eta[k] * (J1[k, a, b] + T[k, a, b])
            for l in range(N):
                S_tf[a, l] += eta[k] * C1[k, a, l]


@kernel
def _turned_inertia(eta: np.ndarray, J2: np.ndarray, T: np.ndarray) -> None:
    """T = sum_l eta_l J2_l (3, 3), in the order in which J2 (N, 3, 3) lies in memory."""
    t00 = t01 = t02 = t10 = t11 = t12 = t20 = t21 = t22 = 0.0
    for l in range(eta.shape[0]):
        e = eta[l]
        t00 += e * J2[l, 0, 0]
        t01 += e * J2[l, 0, 1]
        t02 += e * J2[l, 0, 2]
        t10 += e * J2[l, 1, 0]
        t11 += e * J2[l, 1, 1]
        t12 += e * J2[l, 1, 2]
        t20 += e * J2[l, 2, 0]
        t21 += e * J2[l, 2, 1]
        t22 += e * J2[l, 2, 2]
    T[0, 0], T[0, 1], T[0, 2] = t00, t01, t02
    T[1, 0], T[1, 1], T[1, 2] = t10, t11, t12
    T[2, 0], T[2, 1], T[2, 2] = t20, t21, t22


@kernel
def first_moment(eta: np.ndarray, s0: np.ndarray, S1: np.ndarray, s: np.ndarray) -> None:
    """Fill s (3,) with s0 + S1 eta."""
    for a in range(3):
        total = s0[a]
        for k in range(eta.shape[0]):
            total += S1[a, k] * eta[k]
        s[a] = total


@kernel
def mass_matrix(
    A: np.ndarray,
    m: float,
    s: np.ndarray,
    S1: np.ndarray,
    S_tt: np.ndarray,
    S_tf: np.ndarray,
    Mff: np.ndarray,
    M: np.ndarray,
) -> None:
    """Fill M (6 + N, 6 + N), symmetric; A (3, 3) turns body axes into global ones."""
    N = Mff.shape[0]
    for a in range(3):
        for b in range(3):
            M[a, b] = m if a == b else 0.0
            M[3 + a, 3 + b] = S_tt[a, b]
        M[a, 3] = A[a, 2] * s[1] - A[a, 1] * s[2]
        M[a, 4] = A[a, 0] * s[2] - A[a, 2] * s[0]
        M[a, 5] = A[a, 1] * s[0] - A[a, 0] * s[1]
        for k in range(N):
            M[a, 6 + k] = A[a, 0] * S1[0, k] + A[a, 1] * S1[1, k] + A[a, 2] * S1[2, k]
            M[3 + a, 6 + k] = -S_tf[a, k]
    for k in range(N):
        for l in range(N):
            M[6 + k, 6 + l] = Mff[k, l]
    for i in range(6):
        first = 3 if i < 3 else 6
        for j in range(first, 6 + N):
            M[j, i] = M[i, j]


@kernel
def velocity_forces(
    A: np.ndarray,
    w: np.ndarray,
    etad: np.ndarray,
    s: np.ndarray,
    S1: np.ndarray,
    S_tt: np.ndarray,
    S_tf: np.ndarray,
    J1: np.ndarray,
    T: np.ndarray,
    C1: np.ndarray,
    f: np.ndarray,
) -> None:
    """Fill f (6 + N,) with the quadratic velocity forces at the angular velocity w (3,), body axes."""
    N = etad.shape[0]
    v0, v1, v2 = 0.0, 0.0, 0.0
    for k in range(N):
        v0 += S1[0, k] * etad[k]
        v1 += S1[1, k] * etad[k]
        v2 += S1[2, k] * etad[k]
    # w × (w × s) + 2 w × S1 η̇ = w × c
    c0 = w[1] * s[2] - w[2] * s[1] + 2.0 * v0
    c1 = w[2] * s[0] - w[0] * s[2] + 2.0 * v1
    c2 = w[0] * s[1] - w[1] * s[0] + 2.0 * v2
    g0, g1, g2 = w[1] * c2 - w[2] * c1, w[2] * c0 - w[0] * c2, w[0] * c1 - w[1] * c0
    for a in range(3):
        f[a] = -(A[a, 0] * g0 + A[a, 1] * g1 + A[a, 2] * g2)
    _turning_forces(w, etad, S_tt, S_tf, J1, T, f)
    for l in range(N):
        total = 0.0
        for k in range(N):
            total += 2.0 * etad[k] * (w[0] * C1[k, 0, l] + w[1] * C1[k, 1, l] + w[2] * C1[k, 2, l])
        for a in range(3):
            for b in range(3):
                total += w[a] * (0.5 * J1[l, a, b] + T[l, a, b]) * w[b]
        f[6 + l] = total


@kernel
def _turning_forces(
    w: np.ndarray,
    etad: np.ndarray,
    S_tt: np.ndarray,
    S_tf: np.ndarray,
    J1: np.ndarray,
    T: np.ndarray,
    f: np.ndarray,
) -> None:
    """Rows 3 to 5: -w × (S_tt w - S_tf η̇) - Ṡ_tt w, with Ṡ_tt = sum_k η̇_k (J1_k + T_k + T_kᵀ)."""
    h = (0.0, 0.0, 0.0)
    for b in range(3):
        h = (h[0] + S_tt[0, b] * w[b], h[1] + S_tt[1, b] * w[b], h[2] + S_tt[2, b] * w[b])
    for k in range(etad.shape[0]):
        h = (h[0] - S_tf[0, k] * etad[k], h[1] - S_tf[1, k] * etad[k], h[2] - S_tf[2, k] * etad[k])
    f3, f4, f5 = h[1] * w[2] - h[2] * w[1], h[2] * w[0] - h[0] * w[2], h[0] * w[1] - h[1] * w[0]
    for k in range(etad.shape[0]):
        rate = etad[k]
        for b in range(3):
            f3 -= rate * (J1[k, 0, b] + T[k, 0, b] + T[k, b, 0]) * w[b]
            f4 -= rate * (J1[k, 1, b] + T[k, 1, b] + T[k, b, 1]) * w[b]
            f5 -= rate * (J1[k, 2, b] + T[k, 2, b] + T[k, b, 2]) * w[b]
    f[3], f[4], f[5] = f3, f4, f5


@kernel
def add_gravity(A: np.ndarray, m: float, s: np.ndarray, S1: np.ndarray, g: np.ndarray, f: np.ndarray) -> None:
    """Add gravity g (3,), global axes, m/s²: (66)-(69), M times a uniform acceleration."""
    b0 = A[0, 0] * g[0] + A[1, 0] * g[1] + A[2, 0] * g[2]
    b1 = A[0, 1] * g[0] + A[1, 1] * g[1] + A[2, 1] * g[2]
    b2 = A[0, 2] * g[0] + A[1, 2] * g[1] + A[2, 2] * g[2]
    for a in range(3):
        f[a] += m * g[a]
    f[3] += s[1] * b2 - s[2] * b1
    f[4] += s[2] * b0 - s[0] * b2
    f[5] += s[0] * b1 - s[1] * b0
    for k in range(S1.shape[1]):
        f[6 + k] += S1[0, k] * b0 + S1[1, k] * b1 + S1[2, k] * b2


@kernel
def add_elastic_forces(
    w: np.ndarray,
    eta: np.ndarray,
    etad: np.ndarray,
    Kr: np.ndarray,
    Dr: np.ndarray,
    KG: np.ndarray,
    f: np.ndarray,
) -> float:
    """Add -(K η + D η̇) and the centrifugal stiffening, -sum (w~ w~)_ij KG_ij η; KG (3, 3, N, N) or empty.

    Returns the power of damping and stiffening, W: that of K η is stored.
    """
    N = eta.shape[0]
    square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
    power = 0.0
    for k in range(N):
        stored = lost = 0.0
        for l in range(N):
            stored += Kr[k, l] * eta[l]
            lost += Dr[k, l] * etad[l]
        for i in range(KG.shape[0]):
            for j in range(KG.shape[1]):
                amplitude = w[i] * w[j] - (square if i == j else 0.0)
                for l in range(N):
                    lost += amplitude * KG[i, j, k, l] * eta[l]
        f[6 + k] -= stored + lost
        power -= lost * etad[k]
    return power
