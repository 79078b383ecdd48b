"""Precision to which the digits of the matrix files determine each frequency.

First-order perturbation: with unit modal mass the errors δK, δM of the entries shift the eigenvalue by
φ' δK φ - ω² φ' δM φ, the frequency by half of that over ω², relatively.  Slender bodies lose digits by it:
their strain energy is what large terms φ_i K_ij φ_j of opposite signs leave.

Numbers were rounded to some digits when nearly all of many different ones need just these.  Otherwise a
number has as many digits as the longest that the file prints, zeros included: 0.108 in a file of sixteen
digits means 0.1080000000000000.  Where all are short, like 2.0 and 0.108, they are exact.

Entries that are written alike are rounded alike.  In a regular mesh such errors add up instead of averaging
out, hence the sum over entries of one magnitude before the sum of squares over magnitudes.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .formats.matrix_file import MatrixFile
from .linear_algebra import distinct
from .nodal_matrices import NodalMatrix

# The largest number of decimal digits that double precision always keeps.
DECIMALS = 15
# Decimal digits of single precision; its values are decimals of more digits, of which the last say nothing.
SINGLE = 7
# Programs that print matrices print at least so many digits.
FEWEST_PRINTED = 5
# Of numbers rounded to some digits nine tenths need all of them; a few numbers may do so by chance.
NEED_ALL, BY_CHANCE = 0.7, 10
# Rounded matrices miss twice the root sum of squares in one case of twenty.
MARGIN = 2.0
# Standard deviations that the worst of all rows hardly passes.
BY_ROUNDING = 4.0
# Rounding and the forces of a translation give the same error within these factors; a stiffness that balances
# better has exact numbers (a lumped truss), one that balances worse has errors that its digits do not show.
BALANCED, UNBALANCED = 0.1, 3.0


@dataclass(frozen=True)
class EntryErrors:
    """Standard deviation of the error of every entry (k,); `alike`: entries of one magnitude share it."""

    deviation: np.ndarray
    alike: bool
    digits: int


def frequency_errors(K: NodalMatrix, S: NodalMatrix, shapes: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Relative errors (2, N) to expect of the frequencies of `shapes` (3 n, N), by `K` and by `S`.

    `values` (N,): eigenvalues ω², rad²/s²; the shapes have unit modal mass, axes of the node table.
    """
    of_stiffness = _energy_errors(K, stiffness_errors(K), shapes) / values
    of_mass = _energy_errors(S, rounding_errors(S.file.values, S.file.digits), shapes)
    return MARGIN / 2 * np.vstack([of_stiffness, of_mass])


def rounding_errors(values: np.ndarray, printed: int = 0) -> EntryErrors:
    """Return errors of `values` (k,) that were rounded to as many digits as they have.

    `printed`: digits that the text shows, 0 where there is none.
    """
    needed, single = _decimals(values), values.astype(np.float32)
    rounded = _look_rounded(values, needed)
    digits = needed if rounded else max(needed, printed)
    if needed > SINGLE and (single == values).all():
        return EntryErrors(_uniform(np.spacing(np.abs(single)).astype(float), values), True, SINGLE)
    if digits > DECIMALS or (digits < FEWEST_PRINTED and not rounded):
        return EntryErrors(_uniform(np.spacing(np.abs(values)), values), True, digits)
    power = np.floor(np.log10(np.where(values, np.abs(values), 1.0)))
    return EntryErrors(_uniform(10.0 ** (power + 1 - digits), values), True, digits)


def _decimals(values: np.ndarray) -> int:
    """The significant digits that all values are content with, DECIMALS + 1 where these are too few."""
    magnitudes = distinct(np.abs(values[values != 0]))
    fits = (digits for digits in range(1, DECIMALS + 1) if _fits(magnitudes, digits).all())
    return next(fits, DECIMALS + 1)


def _fits(magnitudes: np.ndarray, digits: int) -> np.ndarray:
    """Return which numbers are content with so many significant digits."""
    unit = 10.0 ** (np.floor(np.log10(magnitudes)) + 1 - digits)
    unit = np.maximum(unit, np.finfo(float).smallest_subnormal)
    return np.abs(np.rint(magnitudes / unit) * unit - magnitudes) <= 1e-15 * magnitudes


def _look_rounded(values: np.ndarray, digits: int) -> bool:
    """Return whether nearly all of many different numbers need all of their digits."""
    magnitudes = distinct(np.abs(values[values != 0]))
    return len(magnitudes) >= BY_CHANCE and bool(np.mean(~_fits(magnitudes, digits - 1)) > NEED_ALL)


def _uniform(unit: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Standard deviation of numbers rounded to multiples of `unit`; zeros are exact."""
    return np.where(values != 0, unit / np.sqrt(12), 0.0)


def rounding_force(file: MatrixFile) -> float:
    """Return what few digits leave of forces that balance, relative to the largest entry; 0 for many digits.

    Fields of fixed width have a digit less for negative numbers.
    """
    if not 1 < file.digits <= SINGLE:
        return 0.0
    power = np.floor(np.log10(np.where(file.values, np.abs(file.values), 1.0)))
    squares = _uniform(10.0 ** (power + 2 - file.digits), file.values) ** 2
    sums = sum(np.bincount(rows, squares[part], file.size) for rows, _, part in _directions(file))
    return float(BY_ROUNDING * np.sqrt(np.max(sums)) / np.abs(file.values).max())


def stiffness_errors(K: NodalMatrix) -> EntryErrors:
    """Return errors of the entries of K by their digits, corrected by the forces of a translation.

    Those sum up a row of errors, and would be zero without.
    """
    file, rounding = K.file, rounding_errors(K.file.values, K.file.digits)
    shifts = K.extended(K.translations)
    forces, expected = np.zeros((2, file.size, 3))
    for rows, columns, part in _directions(file):
        moved = shifts[columns]
        np.add.at(forces, rows, file.values[part, None] * moved)
        np.add.at(expected, rows, (rounding.deviation[part, None] * moved) ** 2)
    ratio = np.sqrt((forces**2).sum() / max(expected.sum(), np.finfo(float).tiny))
    if ratio > UNBALANCED:
        relative = np.abs(file.values) * np.sqrt((forces**2).sum() / _squares(file, shifts))
        return EntryErrors(relative, False, rounding.digits)
    if ratio < BALANCED:
        return EntryErrors(ratio * rounding.deviation, True, rounding.digits)
    return rounding


def _squares(file: MatrixFile, shifts: np.ndarray) -> float:
    return float(
        sum(
            ((file.values[part, None] * shifts[columns]) ** 2).sum() for _, columns, part in _directions(file)
        )
    )


def _directions(file: MatrixFile) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Rows, columns and numbers of the entries; those of a triangle stand for their mirror images too."""
    every = np.arange(len(file.values))
    yield file.rows, file.columns, every
    if file.one_triangle:
        off = every[file.rows != file.columns]
        yield file.columns[off], file.rows[off], off


def _energy_errors(matrix: NodalMatrix, errors: EntryErrors, shapes: np.ndarray) -> np.ndarray:
    """Standard deviations of φ' δ φ, (N,), for the errors δ of the entries of a file."""
    file, energies = matrix.file, np.zeros(shapes.shape[1])
    lower = np.flatnonzero(file.rows >= file.columns)
    if file.one_triangle:
        lower = np.arange(len(file.values))
    rows, columns, values = file.rows[lower], file.columns[lower], file.values[lower]
    weights = np.where(rows == columns, 1.0, 2.0) * np.sign(values)
    _, first, group = np.unique(
        np.abs(values) if errors.alike else np.arange(len(values)), return_index=True, return_inverse=True
    )
    deviation = errors.deviation[lower][first]
    moved = matrix.extended(shapes)
    for k, x in enumerate(moved.T):
        sums = np.bincount(group, weights * x[rows] * x[columns])
        energies[k] = np.linalg.norm(deviation * sums)
    return energies
