"""Geometric stiffness of a straight flexible body under the pull of its own nodes along the beam.

A deflected beam is shorter by half the integral of w'², so that a pull N along it adds the strain
energy of the integral of N w'²/2 (Kane, Ryan and Banerjee, 1987: what linear strains leave out of
rotating beams).  The deflection between the nodes is the cubic spline of least bending energy that is
clamped at the root, the one that gives the condensed stiffness of a uniform beam.
"""

import numpy as np

_BENDING = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]], float)
_STRING = np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]], float) / 30

# Distance of a node from the line, as a share of the beam's length, that counts as round-off of F10.5.
_OFF_LINE = 1e-4


def beam_direction(positions: np.ndarray, root: float) -> np.ndarray | None:
    """Unit vector (3,) along nodes that lie on one line from O_k, all past `root` (m) and apart.

    positions (NP, 3), m; None when they do not.
    """
    distances = np.linalg.norm(positions, axis=1)
    length = float(distances.max())
    if length == 0.0:
        return None
    direction = positions[np.argmax(distances)] / length
    along = positions @ direction
    off = np.linalg.norm(positions - np.outer(along, direction), axis=1)
    stations = np.concatenate([[root], np.sort(along)])
    if off.max() > _OFF_LINE * length or np.diff(stations).min() <= _OFF_LINE * length:
        return None
    return direction


def geometric_stiffness(positions: np.ndarray, root: float, axial_forces: np.ndarray) -> np.ndarray:
    """Matrix (NP, NP), N/m, for deflections across a beam whose nodes pull outward with `axial_forces` (NP,),
    N.

    positions (NP, 3): straight, see `beam_direction`; `root`: clamped end, m from O_k.
    """
    along = positions @ beam_direction(positions, root)
    order = np.argsort(along)
    lengths = np.diff(np.concatenate([[root], along[order]]))
    # An element is pulled by all nodes from its outer end on.
    tensions = np.cumsum(axial_forces[order][::-1])[::-1]
    bending = _assembled(lengths, _BENDING, 1.0 / lengths**3)
    string = _assembled(lengths, _STRING, tensions / lengths)
    deflections, slopes = slice(2, None, 2), slice(3, None, 2)
    follow = -np.linalg.solve(bending[slopes, slopes], bending[slopes, deflections])
    shape = np.zeros((len(string), len(lengths)))
    shape[deflections], shape[slopes] = np.eye(len(lengths)), follow
    matrix = np.zeros((len(lengths), len(lengths)))
    matrix[np.ix_(order, order)] = shape.T @ string @ shape
    return matrix


def across(matrix: np.ndarray, direction: np.ndarray, axes: tuple[int, ...]) -> np.ndarray:
    """(NM, NM) over the displacements of the nodes along `axes`, from (NP, NP) for those across the beam."""
    chosen = np.array(axes) - 1
    projection = np.eye(3) - np.outer(direction, direction)
    return np.kron(matrix, projection[np.ix_(chosen, chosen)])


def _assembled(lengths: np.ndarray, element: np.ndarray, factors: np.ndarray) -> np.ndarray:
    """Sum of elements over deflection and slope of the root and all nodes."""
    matrix = np.zeros((2 * len(lengths) + 2,) * 2)
    for i, (h, factor) in enumerate(zip(lengths, factors, strict=True)):
        scale = np.array([1.0, h, 1.0, h])
        matrix[2 * i : 2 * i + 4, 2 * i : 2 * i + 4] += factor * element * np.outer(scale, scale)
    return matrix
