"""Bodies of bricks and of tetrahedra of any number of nodes, assembled by the textbook, as files of CalculiX.

Zienkiewicz and Taylor, The Finite Element Method: trilinear bricks with 2 x 2 x 2 points, linear tetrahedra.
"""

import itertools

import numpy as np
from scipy import sparse
from scipy.spatial import Delaunay

YOUNG, POISSON, DENSITY = 2.1e11, 0.3, 7850.0
CORNERS = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1)])
CORNERS = np.vstack([CORNERS, CORNERS + [0, 0, 2]])


def lattice(size, count):
    """Places of about `count` nodes in a box, and how many there are along each edge."""
    gap = (np.prod(size) / count) ** (1 / 3)
    shape = [max(3, round(length / gap)) for length in size]
    lines = [np.linspace(0.0, length, n) for length, n in zip(size, shape, strict=True)]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3), shape


def bricks(size, count):
    """Places, K and M of a box of equal bricks."""
    places, shape = lattice(size, count)
    number = np.arange(len(places)).reshape(shape)
    ends = ((c + 1) // 2 for c in CORNERS)
    elements = [number[tuple(slice(e, n - 1 + e) for e, n in zip(end, shape, strict=True))] for end in ends]
    edges = np.array(size) / (np.array(shape) - 1)
    K, M = np.zeros((24, 24)), np.zeros((8, 8))
    for point in itertools.product((-1, 1), repeat=3):
        factors = (1 + CORNERS * np.array(point) / np.sqrt(3)) / 2
        slopes = [CORNERS[:, i] * np.delete(factors, i, axis=1).prod(axis=1) / edges[i] for i in range(3)]
        K += np.prod(edges) / 8 * stiffness(np.array(slopes)[None])[0]
        M += DENSITY * np.prod(edges) / 8 * np.outer(factors.prod(axis=1), factors.prod(axis=1))
    nodes = np.stack([part.ravel() for part in elements], axis=1)
    return places, *assembled(nodes, *(np.broadcast_to(A, (len(nodes), *A.shape)) for A in (K, M)))


def tetrahedra(size, count):
    """Places, K and M of a box of Delaunay's tetrahedra about nodes at random, numbered at random."""
    places, shape = lattice(size, count)
    random = np.random.default_rng(1)
    inside = (places > 1e-9) & (places < np.array(size) - 1e-9)
    places = places + inside * size / (np.array(shape) - 1) * random.uniform(-0.35, 0.35, places.shape)
    places = random.permutation(places)
    nodes = Delaunay(places).simplices
    rows = np.concatenate([np.ones((len(nodes), 4, 1)), places[nodes]], axis=2)
    volumes = np.abs(np.linalg.det(rows)) / 6
    kept = volumes > 1e-3 * np.median(volumes)  # flat ones on the faces
    nodes, rows, volumes = nodes[kept], rows[kept], volumes[kept, None, None]
    M = DENSITY * volumes * (1 + np.eye(4)) / 20
    return places, *assembled(nodes, volumes * stiffness(np.linalg.inv(rows)[:, 1:]), M)


def stiffness(slopes):
    """Products B' D B (e, 3 n, 3 n) for slopes (e, 3, n) of the shape functions."""
    shear = YOUNG / (2 * (1 + POISSON))
    D = np.diag([2.0, 2.0, 2.0, 1.0, 1.0, 1.0]) * shear
    D[:3, :3] += 2 * shear * POISSON / (1 - 2 * POISSON)
    B = np.zeros((len(slopes), 6, slopes.shape[2], 3))
    pairs = [
        (0, 0, 0),
        (1, 1, 1),
        (2, 2, 2),
        (3, 0, 1),
        (3, 1, 0),
        (4, 1, 2),
        (4, 2, 1),
        (5, 0, 2),
        (5, 2, 0),
    ]
    for row, axis, slope in pairs:
        B[:, row, :, axis] = slopes[:, slope]
    B = B.reshape(len(slopes), 6, -1)
    return np.einsum("eai,ab,ebj->eij", B, D, B, optimize=True)


def assembled(nodes, K, M):
    """K (3 n, 3 n) and M (n, n) of all elements, sparse and symmetric."""
    found = []
    for A, rows in ((K, (3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), -1)), (M, nodes)):
        where = np.repeat(rows, rows.shape[1], axis=1).ravel(), np.tile(rows, rows.shape[1]).ravel()
        whole = sparse.coo_matrix((A.ravel(), where)).tocsc()
        found.append((whole + whole.T) / 2)
    return found


def write_calculix(folder, places, K, M):
    """Write node table and files of CalculiX' matrix storage; return the nodes at x = 0, to be held."""
    for A, suffix in ((K, "sti"), (sparse.kron(M, sparse.identity(3)), "mas")):
        upper = sparse.triu(A).tocsc().tocoo()
        lines = zip((upper.row + 1).tolist(), (upper.col + 1).tolist(), upper.data.tolist(), strict=True)
        with open(folder / f"body.{suffix}", "w", encoding="ascii") as file:
            file.writelines("%10d %10d %20.13e\n" % line for line in lines)  # noqa: UP031 - that of C
    rows = [f"{node}.{axis}\n" for node in range(1, len(places) + 1) for axis in (1, 2, 3)]
    (folder / "body.dof").write_text("".join(rows))
    table = [f"{node} {x!r} {y!r} {z!r}\n" for node, (x, y, z) in enumerate(places.tolist(), start=1)]
    (folder / "body.txt").write_text("".join(table))
    return np.flatnonzero(places[:, 0] < 1e-9)
