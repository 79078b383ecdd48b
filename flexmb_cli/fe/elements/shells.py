"""Shells of four nodes: MITC4 with incompatible membrane modes and stabilised drilling rotations.

Dvorkin and Bathe, Eng. Comput. 1 (1984), 77-88: transverse shear is interpolated from the middles of edges;
incompatible modes as in `solid_elements`; drilling as Hughes and Brezzi, Comp. Meth. Appl. Mech. Eng. 72
(1989), 105-121.  All elements at once: arrays begin with the element.  Degrees of freedom of an element: x y
z and the rotations about them of node 1, then of node 2 and so on.
"""

import numpy as np

_CORNERS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)
_GAUSS = np.polynomial.legendre.leggauss(2)[0]
# Rotations about the normal have this share of the membrane's shear stiffness and of the rotary inertia.
DRILLING = 1e-3
# Shear correction of a homogeneous section (Reissner).
SHEAR_SHARE = 5.0 / 6.0
# Order of strains: 11, 22, 12, 13, 23, shears as angles.
_PAIRS = ((0, 0), (1, 1), (0, 1), (0, 2), (1, 2))


def normals(corners: np.ndarray) -> np.ndarray:
    """Normals (m, 4, 3) at the nodes of shells at `corners` (m, 4, 3), not of unit length: 4 times areas."""
    vectors = np.empty_like(corners)
    for k in range(4):
        before, after = corners[:, k - 1] - corners[:, k], corners[:, (k + 1) % 4] - corners[:, k]
        vectors[:, k] = np.cross(after, before)
    return vectors


def shell_stiffness(corners: np.ndarray, thickness: np.ndarray, young: float, poisson: float) -> np.ndarray:
    """K (m, 24, 24), N/m, of shells at `corners` (m, 4, 3), m, of `thickness` (m,), m; `young`, Pa."""
    shells = _Shells(corners, thickness)
    shear = young / (2.0 * (1.0 + poisson))
    hooke = np.zeros((5, 5))
    hooke[:2, :2] = young / (1.0 - poisson**2) * np.array([[1.0, poisson], [poisson, 1.0]])
    hooke[2, 2], hooke[3, 3], hooke[4, 4] = shear, SHEAR_SHARE * shear, SHEAR_SHARE * shear
    whole = np.zeros((len(corners), 28, 28))
    for r in _GAUSS:
        for s in _GAUSS:
            for z in _GAUSS:
                B, volume = shells.strains(r, s, z)
                whole += np.einsum("m,mai,ab,mbj->mij", volume, B, hooke, B, optimize=True)
            twist, area = shells.drilling(r, s)
            factor = DRILLING * shear * thickness * area
            whole[:, :24, :24] += np.einsum("m,mi,mj->mij", factor, twist, twist)
    modes = np.linalg.solve(whole[:, 24:, 24:], whole[:, 24:, :24])
    K: np.ndarray = whole[:, :24, :24] - np.einsum("mai,maj->mij", whole[:, 24:, :24], modes)
    return K


def shell_mass(corners: np.ndarray, thickness: np.ndarray, density: float, extra: np.ndarray) -> np.ndarray:
    """Consistent M (m, 24, 24) of shells of `density`, kg/m³, and `extra` (m,), kg/m²."""
    shells = _Shells(corners, thickness)
    M = np.zeros((len(corners), 4, 6, 4, 6))
    for r in _GAUSS:
        for s in _GAUSS:
            N, _ = _bilinear(r, s)
            _, area = shells.drilling(r, s)
            share = np.einsum("m,a,b->mab", area, N, N)
            normal = shells.frame(r, s)[:, 2]
            about = np.eye(3) - (1.0 - DRILLING) * np.einsum("mi,mj->mij", normal, normal)
            line, rotary = density * thickness + extra, density * thickness**3 / 12.0
            M[:, :, :3, :, :3] += np.einsum("m,mab,ij->maibj", line, share, np.eye(3))
            M[:, :, 3:, :, 3:] += np.einsum("m,mab,mij->maibj", rotary, share, about)
    return M.reshape(-1, 24, 24)


def _bilinear(r: float, s: float) -> tuple[np.ndarray, np.ndarray]:
    """Shape functions (4,) and their derivatives (2, 4) in r and s."""
    a, b = 1 + r * _CORNERS[:, 0], 1 + s * _CORNERS[:, 1]
    return a * b / 4, np.array([_CORNERS[:, 0] * b, _CORNERS[:, 1] * a]) / 4


class _Shells:
    """Shells of bilinear middle surfaces, with a director at every node."""

    def __init__(self, corners: np.ndarray, thickness: np.ndarray) -> None:
        across = normals(corners)
        directors = across / np.linalg.norm(across, axis=2)[..., None] * thickness[:, None, None] / 2
        self.corners, self.directors = corners, directors
        # θ x d = -d x θ: displacement of the end of the director per rotation, (m, 4, 3, 3).
        self.turned = np.cross(np.eye(3), directors[..., None, :]).swapaxes(-1, -2)
        centre = np.einsum("da,mai->mdi", _bilinear(0.0, 0.0)[1], corners)
        # Across the middle line from edge to edge, in the tangent plane of the centre.
        self.side = np.cross(np.cross(centre[:, 0], centre[:, 1]), centre[:, 0])

    def slopes(self, r: float, s: float, z: float) -> tuple[np.ndarray, np.ndarray]:
        """Base vectors g (m, 3, 3), in rows, and derivatives of the displacement (m, 3, 3, 24) in r s z."""
        N, dN = _bilinear(r, s)
        size = len(self.corners)
        factors = np.zeros((2, 3, 4))  # of the node's displacement, and of its director
        factors[0, :2], factors[1, :2], factors[1, 2] = dN, z * dN, N
        base = np.einsum("da,mai->mdi", factors[0], self.corners)
        base += np.einsum("da,mai->mdi", factors[1], self.directors)
        moved = np.zeros((size, 3, 3, 4, 6))
        moved[..., :3] = np.einsum("da,ij->diaj", factors[0], np.eye(3))
        moved[..., 3:] = np.einsum("da,maij->mdiaj", factors[1], self.turned)
        return base, moved.reshape(size, 3, 3, 24)

    def frame(self, r: float, s: float) -> np.ndarray:
        """Axes (m, 3, 3), in rows: two of the tangent plane, near those of the centre, and the normal."""
        _, dN = _bilinear(r, s)
        g = np.einsum("da,mai->mdi", dN, self.corners)
        normal = np.cross(g[:, 0], g[:, 1])
        rows = [np.cross(self.side, normal), np.cross(normal, np.cross(self.side, normal)), normal]
        return np.stack([row / np.linalg.norm(row, axis=1)[:, None] for row in rows], axis=1)

    def strains(self, r: float, s: float, z: float) -> tuple[np.ndarray, np.ndarray]:
        """B (m, 5, 28) in the axes of `frame`, of nodes and four incompatible modes; volumes (m,)."""
        base, moved = self.slopes(r, s, z)
        B = np.zeros((len(base), 3, 3, 24))
        for i, j in ((0, 0), (1, 1), (0, 1)):
            B[:, i, j] = B[:, j, i] = _covariant(base, moved, i, j)
        for i, place in ((0, s), (1, r)):
            for end in (-1.0, 1.0):
                at = (0.0, end) if i == 0 else (end, 0.0)
                share = (1 + end * place) / 2 * _covariant(*self.slopes(*at, z), i, 2)
                B[:, i, 2] += share
                B[:, 2, i] += share
        axes = np.einsum("mai,mid->mad", self.frame(r, s), np.linalg.inv(base))
        local = np.einsum("mai,mbj,mijk->mabk", axes, axes, B, optimize=True)
        rows = [local[:, a, b] * (1 if a == b else 2) for a, b in _PAIRS]
        volume = np.linalg.det(base)
        return np.concatenate([np.stack(rows, axis=1), self._modes(r, s, volume)], axis=2), volume

    def _modes(self, r: float, s: float, volume: np.ndarray) -> np.ndarray:
        """Strains (m, 5, 4) of 1 - r² and 1 - s² along both axes of the centre's tangent plane."""
        base = self.slopes(0.0, 0.0, 0.0)[0]
        inverse = np.einsum("mai,mid->mad", self.frame(0.0, 0.0), np.linalg.inv(base))
        scale = np.linalg.det(base) / volume
        rows = np.zeros((len(base), 5, 4))
        for k, slope in enumerate((-2 * r, -2 * s)):
            gradient = slope * scale[:, None] * inverse[:, :2, k]
            rows[:, 0, 2 * k], rows[:, 1, 2 * k + 1] = gradient[:, 0], gradient[:, 1]
            rows[:, 2, 2 * k], rows[:, 2, 2 * k + 1] = gradient[:, 1], gradient[:, 0]
        return rows

    def drilling(self, r: float, s: float) -> tuple[np.ndarray, np.ndarray]:
        """Rotation about the normal less that of the middle surface, (m, 24); areas (m,)."""
        base, moved = self.slopes(r, s, 0.0)
        e1, e2, normal = np.moveaxis(self.frame(r, s), 1, 0)
        area = np.linalg.norm(np.cross(base[:, 0], base[:, 1]), axis=1)
        # Derivatives along e1 and e2 from those along g1 and g2.
        plane = np.linalg.inv(np.einsum("mdi,mai->mda", base[:, :2], np.stack([e1, e2], axis=1)))
        along = np.einsum("mad,mdik->maik", plane, moved[:, :2])
        twist = np.einsum("mi,mik->mk", e1, along[:, 1]) - np.einsum("mi,mik->mk", e2, along[:, 0])
        difference = (twist / 2).reshape(-1, 4, 6)
        difference[..., 3:] += np.einsum("a,mi->mai", _bilinear(r, s)[0], normal)
        return difference.reshape(-1, 24), area


def _covariant(base: np.ndarray, moved: np.ndarray, i: int, j: int) -> np.ndarray:
    """Covariant strain ε_ij (m, 24) from base vectors and derivatives of the displacement."""
    one = np.einsum("mx,mxk->mk", base[:, i], moved[:, j])
    return (one + np.einsum("mx,mxk->mk", base[:, j], moved[:, i])) / 2
