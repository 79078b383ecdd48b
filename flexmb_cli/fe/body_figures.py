"""Figures of a body's basis: modal mass and damping, precision of frequencies, effective masses."""

import math
from typing import Any

import numpy as np

from ..model.diagnostics import Findings
from ..model.flexible_body import FlexibleInput
from .body_basis import Basis
from .linear_algebra import Matrix, all_but, of_mass
from .massless_shapes import massless_in_motion, split_by_mass, static_mass
from .nodal_matrices import NodalMatrix
from .precision import frequency_errors
from .reference_frame import Frame, without_momentum

# A relative error of a frequency that is worth a warning.
DOUBTFUL_FREQUENCY = 1e-3


def completed_mass(Mff: np.ndarray, S: Matrix, frame: Frame, basis: Basis) -> tuple[np.ndarray, int]:
    """`Mff` (N, N) with mass for shapes without, and how many have none once the body moves.

    Shapes without mass get a unit mass each; without it they would have no acceleration.  It couples them to
    nothing, and puts them at the highest frequency of the others, where they follow the loads as the modes
    there do.
    """
    first = len(Mff) - basis.massless
    completed = np.eye(len(Mff))
    completed[:first, :first] = Mff[:first, :first]
    moving = _massless_in_motion(S, frame, basis)
    if moving.shape[1]:
        completed += static_mass(basis.values, moving)
    return completed, moving.shape[1]


def _massless_in_motion(S: Matrix, frame: Frame, basis: Basis) -> np.ndarray:
    """Amplitudes (N, k) of the deformations that a rigid motion rids of their mass; none in mean axes."""
    heavy = len(basis.values) - basis.massless
    amplitudes = np.zeros((len(basis.values), 0))
    if not frame.mean and heavy:
        heavy_amplitudes = massless_in_motion(S, without_momentum(frame, basis.shapes[:, :heavy], S))
        amplitudes = np.zeros((len(basis.values), heavy_amplitudes.shape[1]))
        amplitudes[:heavy] = heavy_amplitudes
    return amplitudes


def modal_damping(given: FlexibleInput, Mff: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Damping (N, N): alpha Mff + beta Kr, and a ratio for each mode of eigenvalue `values` (N,)."""
    alpha, beta, ratio = given.damping
    omega = np.sqrt(np.maximum(values, 0.0))
    ratios = np.full(len(values), ratio)
    if given.ratios:
        frequencies, ratios_there = np.array(given.ratios).T
        ratios = np.interp(omega / math.tau, frequencies, ratios_there)
    return alpha * Mff + beta * np.diag(values) + np.diag(2.0 * ratios * omega)


def effective_limit(S: Any, frame: Frame) -> np.ndarray:
    """Sums of the effective masses over all modes: R' S R less what only the held degrees of freedom
    carry.
    """
    if frame.mean:
        return np.zeros(6)
    free = all_but(S.shape[0], frame.held)
    carried = (S @ frame.motions)[free]
    inner = S[free][:, free]
    if not isinstance(inner, np.ndarray):
        return np.asarray(np.einsum("ij,ij->j", carried, of_mass(inner, carried)))
    # Shapes without mass make the matrix singular; they carry nothing.
    split = split_by_mass(inner)
    of_masses: np.ndarray = np.sum((split.heavy.T @ carried) ** 2 / split.masses[:, None], axis=0)
    return of_masses


def doubtful_frequencies(
    given: FlexibleInput, K: NodalMatrix, S: NodalMatrix, shapes: np.ndarray, basis: Basis, findings: Findings
) -> np.ndarray:
    """Relative errors (N,) of the frequencies by the digits of the files; nan for shapes without mass.

    `shapes` (k, heavy) are those with mass, rows of the files.
    """
    heavy = shapes.shape[1]
    errors = np.full(len(basis.values), np.nan)
    parts = frequency_errors(K, S, shapes, basis.values[:heavy])
    errors[:heavy] = np.hypot(*parts)
    worst = int(np.argmax(errors[:heavy]))
    if errors[worst] > DOUBTFUL_FREQUENCY:
        by_mass = parts[1, worst] > parts[0, worst]
        message = (
            f"the digits of the {'mass' if by_mass else 'stiffness'} matrix leave mode {worst + 1}, "
            f"{math.sqrt(basis.values[worst]) / math.tau:.4g} Hz, a relative error of about "
            f"{errors[worst]:.0e}; export it with more digits, in double precision"
        )
        findings.warn(given.name, message, (given.mass if by_mass else given.stiffness).place, id="FE-012")
    return errors
