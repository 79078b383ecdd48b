"""Linear tetrahedra, written from the textbook: bodies whose mass matrices are only semidefinite."""

import numpy as np

from flexmb_cli.fe.elements.solid_elements import elasticity


def tetrahedra(positions, elements, young, poisson, density):
    """K of linear tetrahedra, and their mass integrated at one point each: rho V/16 for every two nodes.

    Zienkiewicz and Taylor, The Finite Element Method: gradients of N from the inverse of rows (1, x, y, z).
    """
    size = 3 * len(positions)
    K, m, D = np.zeros((size, size)), np.zeros((size // 3, size // 3)), elasticity(young, poisson)
    for nodes in np.array(elements) - 1:
        rows = np.column_stack([np.ones(4), positions[nodes]])
        volume, (dx, dy, dz) = np.linalg.det(rows) / 6, np.linalg.inv(rows)[1:]
        B, o = np.zeros((6, 4, 3)), np.zeros(4)
        parts = [(dx, o, o), (o, dy, o), (o, o, dz), (dy, dx, o), (o, dz, dy), (dz, o, dx)]
        for row, part in enumerate(parts):
            B[row] = np.array(part).T
        places = (3 * nodes[:, None] + np.arange(3)).ravel()
        K[np.ix_(places, places)] += volume * B.reshape(6, 12).T @ D @ B.reshape(6, 12)
        m[np.ix_(nodes, nodes)] += density * volume / 16
    return K, np.kron(m, np.eye(3))
