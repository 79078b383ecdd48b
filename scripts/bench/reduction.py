"""Twenty modes of large finite-element bodies: flexmb from files to the reduced body, and `eigsh` alone.

    scripts/bench/run reduction [NODES...] [--body slender bricks tetrahedra] [--without-eigsh]

Processes of their own take turns; times are their processor seconds, of flexmb with its imports and with what
reading takes, of `eigsh` of its call alone.  The error is that of the frequencies against `eigsh`, whose
matrices are those in memory, while the files have fourteen digits.  Without `eigsh`, a second run finds the
body kept.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import solid_meshes
from scipy import sparse

BODIES = {
    "slender": (solid_meshes.bricks, (1.0, 0.1, 0.1)),
    "bricks": (solid_meshes.bricks, (1.0, 0.2, 0.2)),
    "tetrahedra": (solid_meshes.tetrahedra, (1.0, 0.2, 0.2)),
}
MODES = 20


def eigsh(folder):
    """Frequencies, Hz, of the body held at x = 0, and the processor time of `eigsh`."""
    from scipy.sparse.linalg import eigsh

    K, M = (sparse.load_npz(folder / f"{letter}.npz").tocsc() for letter in "KM")
    begin = time.process_time()
    values = eigsh(K, MODES, M, sigma=0.0, return_eigenvectors=True)[0]
    return np.sqrt(np.sort(values)) / (2 * np.pi), time.process_time() - begin


def flexmb(folder):
    """The same of flexmb, from the files or, the second time, from the body kept."""
    from flexmb_cli.fe.flexible_bodies import flexible_body
    from flexmb_cli.fe.formats.node_table import read_node_table
    from flexmb_cli.model.flexible_body import FEFile, FlexibleInput

    table = read_node_table(folder / "body.txt", "TXT")
    mass, stiffness, mapping = (FEFile(folder / f"body.{suffix}", "CCX") for suffix in ("mas", "sti", "dof"))
    held = tuple(np.load(folder / "held.npy").tolist())
    given = FlexibleInput(
        "body", mass, stiffness, table.numbers, table.positions, mapping, clamped=held, modes=MODES
    )
    return flexible_body(given)[0].frequencies, time.process_time()


def measured(folder, name):
    """Frequencies, processor seconds and peak memory, GB, of a process of its own."""
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "FLEXMB_CACHE_DIR": str(folder / "kept")}
    command = [sys.executable, __file__, "--child", name, str(folder)]
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    frequencies, seconds, peak = json.loads(done.stdout)
    return np.array(frequencies), seconds, peak


def child(name, folder):
    """Print what `measured` reads."""
    import resource

    frequencies, seconds = {"eigsh": eigsh, "flexmb": flexmb}[name](folder)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(json.dumps([list(frequencies), seconds, peak]))


def compared(body, count, with_eigsh=True):
    """Compare a body of about `count` nodes with `eigsh`.

    Returns the number of nodes, (seconds, GB) of flexmb with its imports, of `eigsh` and, last, the error of
    the frequencies; without `eigsh`, (seconds,) of the body kept stand there.
    """
    make, size = BODIES[body]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        places, K, M = make(size, count)
        held = solid_meshes.write_calculix(folder, places, K, M)
        np.save(folder / "held.npy", held + 1)
        free = np.setdiff1d(np.arange(3 * len(places)), (3 * held[:, None] + np.arange(3)).ravel())
        for letter, A in (("K", K), ("M", sparse.kron(M, sparse.identity(3)).tocsc())):
            sparse.save_npz(folder / f"{letter}.npz", A[free][:, free])
        found, *own = measured(folder, "flexmb")
        if not with_eigsh:
            return len(places), own, measured(folder, "flexmb")[1:2], None
        wanted, *alone = measured(folder, "eigsh")
    return len(places), own, alone, np.abs(found / wanted - 1).max()


def compare(body, count, with_eigsh):
    """Print the row of a body with about `count` nodes."""
    nodes, (seconds, peak), other, error = compared(body, count, with_eigsh)
    row = f"{body:10} {nodes:7d} {seconds:9.2f} {peak:5.2f}"
    if with_eigsh:
        row += f" {other[0]:8.2f} {other[1]:5.2f} {seconds / other[0]:6.2f} {error:8.1e}"
    else:
        row += f" {other[0]:8.2f}"
    print(row, flush=True)


def main():
    """Print a table of the bodies."""
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    parser.add_argument("nodes", nargs="*", type=int, default=[10_000])
    parser.add_argument("--body", nargs="+", choices=BODIES, default=list(BODIES))
    parser.add_argument("--without-eigsh", action="store_true")
    parser.add_argument("--child", nargs=2, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.child:
        child(given.child[0], Path(given.child[1]))
        return
    other = "  kept, s" if given.without_eigsh else " eigsh, s    GB  ratio    error"
    print(f"body         nodes flexmb, s    GB{other}")
    for count in given.nodes:
        for body in given.body:
            compare(body, count, not given.without_eigsh)


if __name__ == "__main__":
    main()
