"""Bricks of eight nodes by loops over points and nodes: full integration, and mean dilatation (B-bar).

Hughes, The Finite Element Method (1987), section 4.5.2: B-bar = B + (B_dil of the mean gradients - B_dil),
the mean being that over the element's volume (Nagtegaal, Parks and Rice, 1974).
"""

import numpy as np

SIGNS = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
POINTS = [np.array(sign) / np.sqrt(3) for sign in SIGNS]


def hooke(young, poisson):
    """Stiffness (6, 6) by inverting the compliance: xx yy zz xy yz zx, shears as angles."""
    shear = young / (2 * (1 + poisson))
    compliance = np.diag([1 / young] * 3 + [1 / shear] * 3)
    compliance[:3, :3] -= poisson / young * (1 - np.eye(3))
    return np.linalg.inv(compliance)


def shapes(point):
    return np.array([np.prod([1 + s * x for s, x in zip(sign, point, strict=True)]) / 8 for sign in SIGNS])


def natural_gradients(point):
    """dN/dxi (8, 3)."""
    found = np.empty((8, 3))
    for a, sign in enumerate(SIGNS):
        factors = [1 + s * x for s, x in zip(sign, point, strict=True)]
        for d in range(3):
            found[a, d] = sign[d] * np.prod([f for e, f in enumerate(factors) if e != d]) / 8
    return found


def strains(place, averaged):
    """B (6, 24) and volumes at the eight points of one element whose nodes lie at `place` (8, 3)."""
    gradients, volumes = [], []
    for point in POINTS:
        natural = natural_gradients(point)
        J = place.T @ natural
        gradients.append(natural @ np.linalg.inv(J))
        volumes.append(np.linalg.det(J))
    mean = sum(v * g for v, g in zip(volumes, gradients, strict=True)) / sum(volumes)
    found = []
    for gradient in gradients:
        B = np.zeros((6, 24))
        for a, (dx, dy, dz) in enumerate(gradient):
            B[:, 3 * a : 3 * a + 3] = [
                [dx, 0, 0],
                [0, dy, 0],
                [0, 0, dz],
                [dy, dx, 0],
                [0, dz, dy],
                [dz, 0, dx],
            ]
            if averaged:
                for row in range(3):
                    B[row, 3 * a : 3 * a + 3] += (mean[a] - gradient[a]) / 3
        found.append(B)
    return found, volumes


def matrices(positions, rows, material, *, averaged, lumped=False):
    """M and K (3 n, 3 n) of a mesh; `material`: Young's modulus, Poisson's ratio, density."""
    young, poisson, density = material
    D, size = hooke(young, poisson), 3 * len(positions)
    M, K = np.zeros((size, size)), np.zeros((size, size))
    for nodes in rows:
        B, volumes = strains(positions[nodes], averaged)
        own = np.concatenate([3 * np.array(nodes)[:, None] + np.arange(3)]).ravel()
        mass = np.zeros((8, 8))
        for b, v, point in zip(B, volumes, POINTS, strict=True):
            K[np.ix_(own, own)] += v * b.T @ D @ b
            mass += density * v * np.outer(shapes(point), shapes(point))
        mass = np.diag(mass.sum(axis=1)) if lumped else mass
        M[np.ix_(own, own)] += np.kron(mass, np.eye(3))
    return M, K
