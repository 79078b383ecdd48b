"""Random bodies whose answers are known from sums over nodes: trusses of massive nodes and bars."""

import numpy as np

from flexmb_cli.model.flexible_body import FEFile, FlexibleInput


def write_matrix(path, matrix, symmetric=True):
    """A Matrix Market file of seventeen digits."""
    rows, columns = np.nonzero(np.tril(matrix) if symmetric else matrix)
    kind = "symmetric" if symmetric else "general"
    lines = [f"%%MatrixMarket matrix coordinate real {kind}", f"{len(matrix)} {len(matrix)} {len(rows)}"]
    lines += [f"{i + 1} {j + 1} {matrix[i, j]:.17g}" for i, j in zip(rows, columns, strict=True)]
    path.write_text("\n".join(lines) + "\n")


def truss(seed, n=7):
    """Positions (n, 3), coupled masses m (n, n), mass (3 n, 3 n) and stiffness of a truss of all bars."""
    random = np.random.default_rng(seed)
    r = random.uniform(-1, 1, (n, 3))
    root = random.uniform(0, 0.3, (n, n)) + np.diag(random.uniform(1, 2, n))
    m = root @ root.T
    K = np.zeros((3 * n, 3 * n))
    for i in range(n):
        for j in range(i):
            along = (r[i] - r[j]) / np.linalg.norm(r[i] - r[j])
            bar, ends = np.concatenate([along, -along]), np.add.outer([3 * i, 3 * j], range(3)).ravel()
            K[np.ix_(ends, ends)] += random.uniform(50, 200) * np.outer(bar, bar)
    return r, m, np.kron(m, np.eye(3)), K


def truss_input(folder, seed, n=7, **choices):
    """The truss as files in `folder`, node numbers 11, 12, ..."""
    r, _, M, K = truss(seed, n)
    return files_input(folder, r, M, K, **choices)


def files_input(folder, r, M, K, symmetric=True, **choices):
    write_matrix(folder / "M.mtx", M, symmetric)
    write_matrix(folder / "K.mtx", K, symmetric)
    mass, stiffness = FEFile(folder / "M.mtx", "MM"), FEFile(folder / "K.mtx", "MM")
    return FlexibleInput("body 1", mass, stiffness, np.arange(11, 11 + len(r)), r, **choices)
