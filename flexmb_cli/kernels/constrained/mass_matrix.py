"""Mass matrix and quadratic velocity forces of all bodies in the speeds (ṙ, ω, η̇), ω in body axes.

VSDFlex paper (2008), equations (55) and (75)-(77); for a rigid body

    M = [ m E        -A s~ ]      f = [ -A ω~ ω~ s ]      s = m c, J about the origin
        [ (-A s~)ᵀ     J   ]          [  -ω~ J ω   ]

and for a flexible one `floating_frame`.  M is kept body by body: work.mass (bodies, 6, 6) of the rigid ones,
whole blocks (6 + N, 6 + N) of the flexible ones in work.modal.
"""

import numpy as np

from .._jit import kernel, part
from ..linalg.number_rows import block
from ..linalg.rotation import A
from . import floating_frame
from .system import PRODUCT, System, Work


@part
def constants_of(flat: np.ndarray, f: np.void) -> tuple[np.ndarray, ...]:
    """Return S1 (3, N), J1 (N, 3, 3), J2 (N, N, 3, 3), C0 (3, N), C1 (N, 3, N), Mff, Kr, Dr (N, N) and KG.

    flat (k,): `System.modal`; f: the FLEXIBLE record of the body.
    """
    N, at, side = f["modes"], f["constants"], 3 * f["stiffened"]
    S1, J1, J2 = (
        block(flat, at, (3, N)),
        block(flat, at + 3 * N, (N, 3, 3)),
        block(flat, at + 12 * N, (N, N, 3, 3)),
    )
    at += 12 * N + 9 * N * N
    C0, C1 = block(flat, at, (3, N)), block(flat, at + 3 * N, (N, 3, N))
    at += 3 * N + 3 * N * N
    Mff, Kr, Dr = (
        block(flat, at, (N, N)), block(flat, at + N * N, (N, N)), block(flat, at + 2 * N * N, (N, N)),
    )  # fmt: skip
    return S1, J1, J2, C0, C1, Mff, Kr, Dr, block(flat, at + 3 * N * N, (side, side, N, N))


@part
def places_of(flat: np.ndarray, f: np.void) -> tuple[np.ndarray, ...]:
    """Return s (3,), S_tt (3, 3), S_tf (3, N), T (N, 3, 3), the mass matrix and forces of a body: its work.

    flat (k,): `Work.modal`; f: the FLEXIBLE record of the body.
    """
    N, at = f["modes"], f["places"]
    width, end = 6 + N, at + 12 + 12 * N
    s, S_tt = block(flat, at, (3,)), block(flat, at + 3, (3, 3))
    S_tf, T = block(flat, at + 12, (3, N)), block(flat, at + 12 + 3 * N, (N, 3, 3))
    return s, S_tt, S_tf, T, block(flat, end, (width, width)), block(flat, end + width * width, (width,))


@kernel
def mass_matrices(system: System, work: Work, q: np.ndarray) -> None:
    """Fill the mass matrices at q, where the rotation matrices belong to q."""
    masses = system.masses
    for b in range(masses.shape[0]):
        if masses[b]["flexible"] < 0:
            axes, m, s, J = work.rotations[A, b], masses[b]["mass"], masses[b]["moment"], masses[b]["inertia"]
            modes = axes[:, :0]  # none
            floating_frame.mass_matrix(axes, m, s, modes, J, modes, axes[:0, :0], work.mass[b])
    for k in range(system.flexible.shape[0]):
        _flexible_mass(system, work, system.flexible[k], q)


@part
def _flexible_mass(system: System, work: Work, f: np.void, q: np.ndarray) -> None:
    S1, J1, J2, C0, C1, Mff, _, _, _ = constants_of(system.modal, f)
    s, S_tt, S_tf, T, M, _ = places_of(work.modal, f)
    b, at = f["body"], 7 * system.masses.shape[0] + f["first"]
    eta, mass = q[at : at + f["modes"]], system.masses[b]
    floating_frame.first_moment(eta, mass["moment"], S1, s)
    floating_frame.moving_inertia(eta, mass["inertia"], J1, J2, C0, C1, T, S_tt, S_tf)
    floating_frame.mass_matrix(work.rotations[A, b], mass["mass"], s, S1, S_tt, S_tf, Mff, M)


@kernel
def mass_times(system: System, work: Work, x: np.ndarray, y: np.ndarray) -> None:
    """y = M x for x, y (n,); zeros in x cost nothing."""
    masses = system.masses
    for k in range(x.shape[0]):
        y[k] = 0.0
    for b in range(masses.shape[0]):
        if masses[b]["flexible"] < 0:
            for j in range(6):
                amount = x[6 * b + j]
                if amount != 0.0:
                    for i in range(6):
                        y[6 * b + i] += work.mass[b, j, i] * amount
    for k in range(system.flexible.shape[0]):
        f = system.flexible[k]
        M, N = places_of(work.modal, f)[4], f["modes"]
        rigid, modal = 6 * f["body"], 6 * masses.shape[0] + f["first"]
        for j in range(6 + N):
            amount = x[rigid + j if j < 6 else modal + j - 6]
            if amount != 0.0:
                for i in range(6):
                    y[rigid + i] += M[j, i] * amount
                for i in range(N):
                    y[modal + i] += M[j, 6 + i] * amount


@part
def inertia_and_elastic_forces(
    system: System, work: Work, q: np.ndarray, u: np.ndarray, f: np.ndarray
) -> float:
    """Fill f (n,) with quadratic velocity forces, gravity, elastic forces; the mass matrices belong to q.

    Returns the power of those that store no energy: damping and centrifugal stiffening.
    """
    masses, g = system.masses, system.gravity
    for b in range(masses.shape[0]):
        if masses[b]["flexible"] < 0:
            _gyroscopic_forces(masses[b], work.rotations[A, b], u[6 * b : 6 * b + 6], f[6 * b : 6 * b + 6])
            m, s, axes = masses[b]["mass"], masses[b]["moment"], work.rotations[A, b]
            floating_frame.add_gravity(axes, m, s, axes[:, :0], g, f[6 * b : 6 * b + 6])
    power = 0.0
    for k in range(system.flexible.shape[0]):
        power += _flexible_forces(system, work, system.flexible[k], q, u, f)
    return power


@part
def _gyroscopic_forces(mass: np.void, axes: np.ndarray, u: np.ndarray, f: np.ndarray) -> None:
    s, J = mass["moment"], mass["inertia"]
    w0, w1, w2 = u[3], u[4], u[5]
    along = w0 * s[0] + w1 * s[1] + w2 * s[2]
    square = w0 * w0 + w1 * w1 + w2 * w2
    # -ω × (ω × s)
    c0, c1, c2 = square * s[0] - along * w0, square * s[1] - along * w1, square * s[2] - along * w2
    for i in range(3):
        f[i] = axes[i, 0] * c0 + axes[i, 1] * c1 + axes[i, 2] * c2
    h0 = J[0, 0] * w0 + J[0, 1] * w1 + J[0, 2] * w2
    h1 = J[1, 0] * w0 + J[1, 1] * w1 + J[1, 2] * w2
    h2 = J[2, 0] * w0 + J[2, 1] * w1 + J[2, 2] * w2
    f[3] = h1 * w2 - h2 * w1
    f[4] = h2 * w0 - h0 * w2
    f[5] = h0 * w1 - h1 * w0


@part
def _flexible_forces(
    system: System, work: Work, flexible: np.void, q: np.ndarray, u: np.ndarray, f: np.ndarray
) -> float:
    S1, J1, _, _, C1, _, Kr, Dr, KG = constants_of(system.modal, flexible)
    s, S_tt, S_tf, T, _, own = places_of(work.modal, flexible)
    b, N, bodies = flexible["body"], flexible["modes"], system.masses.shape[0]
    axes, first = work.rotations[A, b], flexible["first"]
    eta, w = q[7 * bodies + first : 7 * bodies + first + N], u[6 * b + 3 : 6 * b + 6]
    etad = u[6 * bodies + first : 6 * bodies + first + N]
    floating_frame.velocity_forces(axes, w, etad, s, S1, S_tt, S_tf, J1, T, C1, own)
    floating_frame.add_gravity(axes, system.masses[b]["mass"], s, S1, system.gravity, own)
    power = floating_frame.add_elastic_forces(w, eta, etad, Kr, Dr, KG, own)
    for i in range(6):
        f[6 * b + i] = own[i]
    for k in range(N):
        f[6 * bodies + first + k] = own[6 + k]
    return power


@kernel
def kinetic_energy(system: System, work: Work, u: np.ndarray) -> float:
    """½ uᵀ M u, J."""
    product, total = work.vectors[PRODUCT], 0.0
    mass_times(system, work, u, product)
    for k in range(u.shape[0]):
        total += 0.5 * u[k] * product[k]
    return total


@kernel
def strain_energy(system: System, q: np.ndarray) -> float:
    """½ ηᵀ K η of all flexible bodies, J."""
    total = 0.0
    for k in range(system.flexible.shape[0]):
        f = system.flexible[k]
        N, at, K = f["modes"], 7 * system.masses.shape[0] + f["first"], constants_of(system.modal, f)[6]
        for i in range(N):
            for j in range(N):
                total += 0.5 * q[at + i] * K[i, j] * q[at + j]
    return total


@kernel
def weight_energy(system: System, work: Work, q: np.ndarray) -> float:
    """Energy of gravity, J, where rotation matrices and mass matrices belong to q."""
    total, g = 0.0, system.gravity
    for b in range(system.masses.shape[0]):
        mass, axes = system.masses[b], work.rotations[A, b]
        moment = mass["moment"]
        s = (moment[0], moment[1], moment[2])
        if mass["flexible"] >= 0:
            moved = places_of(work.modal, system.flexible[mass["flexible"]])[0]
            s = (moved[0], moved[1], moved[2])
        for i in range(3):
            body_vector = axes[i, 0] * s[0] + axes[i, 1] * s[1] + axes[i, 2] * s[2]
            total -= g[i] * (mass["mass"] * q[7 * b + i] + body_vector)
    return total
