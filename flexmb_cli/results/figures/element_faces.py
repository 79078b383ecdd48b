"""Outer faces of solid elements: those that no other element shares, and their triangles and edges."""

import numpy as np

# Corners of the faces, anticlockwise from outside, and the edges with their middles, nodes from 0.
_HEXAHEDRON = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
_HEXAHEDRON_EDGES = (
    (0, 1),
    (1, 2),
    (2, 3),
    (3, 0),
    (4, 5),
    (5, 6),
    (6, 7),
    (7, 4),
    (0, 4),
    (1, 5),
    (2, 6),
    (3, 7),
)
_TETRAHEDRON = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
_TETRAHEDRON_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
FACES = {4: _TETRAHEDRON, 8: _HEXAHEDRON, 10: _TETRAHEDRON, 20: _HEXAHEDRON}
_EDGES = {10: _TETRAHEDRON_EDGES, 20: _HEXAHEDRON_EDGES}
# Triangles of a face by its nodes in turn: corners alone, or a corner and the middle behind it.
_TRIANGLES = {
    3: ((0, 1, 2),),
    4: ((0, 1, 2), (0, 2, 3)),
    6: ((0, 1, 5), (2, 3, 1), (4, 5, 3), (1, 3, 5)),
    8: ((0, 1, 7), (2, 3, 1), (4, 5, 3), (6, 7, 5), (1, 3, 5), (1, 5, 7)),
}


def outer_faces_of_elements(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the faces (f, s) that only one element has, and the rows (f,) of `cells` (m, k) that have them.

    A face has its nodes in turn, from outside; that of a quadratic element its middles between its corners.
    """
    faces = _rings(cells.shape[1])
    corners = 3 if cells.shape[1] in (4, 10) else 4
    every = cells[:, faces].reshape(-1, faces.shape[1])
    # Middles follow from the corners.
    keys = np.sort(every[:, :: faces.shape[1] // corners], axis=1)
    _, first, counts = np.unique(keys, axis=0, return_index=True, return_counts=True)
    outer = np.sort(first[counts == 1])
    return every[outer], outer // len(faces)


def _rings(nodes: int) -> np.ndarray:
    """Nodes of the faces of an element of so many nodes, in turn."""
    middles = {
        frozenset(edge): middle
        for middle, edge in enumerate(_EDGES.get(nodes, ()), start=4 if nodes == 10 else 8)
    }
    rings = []
    for face in FACES[nodes]:
        ring = []
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            ring += [a, middles[frozenset((a, b))]] if middles else [a]
        rings.append(ring)
    return np.array(rings)


def triangles(faces: np.ndarray) -> np.ndarray:
    """Triangles (t, 3) of faces (f, s)."""
    return faces[:, _TRIANGLES[faces.shape[1]]].reshape(-1, 3)


def face_edges(faces: np.ndarray) -> np.ndarray:
    """Lines (l, 2) along the edges of faces (f, s), each once."""
    pairs = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    return np.unique(np.sort(pairs, axis=1), axis=0)
