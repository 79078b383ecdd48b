"""Frequencies of bodies whose matrices are rounded: how far they move, and what `flexmb modes` expects.

Example: scripts/bench/run file_digits --digits 6 8 10

Bodies: the pendulum of decks/vsdf (three frames), the clamped rod of its spin-up, the rod of CalculiX.  The
exact matrices are those of the files.  The stiffness, then stiffness and mass, are rounded to so many digits
or to single precision, or every entry of the stiffness gets noise of three millionths.  Counted are the
frequencies that move farther than the error printed beside them, where that is below a half.
"""

import argparse
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.io import mmwrite
from scipy.sparse import coo_matrix

from flexmb_cli.errors import ModelError
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.fe.formats.formats import read_matrix
from flexmb_cli.fe.formats.node_table import read_node_table
from flexmb_cli.fe.nodal_matrices import condensed
from flexmb_cli.model.flexible_body import FEFile, FlexibleInput

FILES = Path(__file__).resolve().parents[2] / "decks/vsdf/fe"
BODIES = {
    "pendulum, near the joint": ("pendulum", {"reference": (1, 13, 9)}),
    "pendulum, clamped": ("pendulum", {"clamped": (1, 2, 3, 4, 5, 6)}),
    "pendulum, mean axes": ("pendulum", {}),
    "spin-up, clamped": ("spinup", {"clamped": (1, 2, 3, 4)}),
    "rod of CalculiX": ("rod", {"reference": (7, 83, 11)}),
}
MODES = 10
LARGEST = 0.5  # error expected, beyond which first order says nothing
NOISE = 3e-6


def files_of(name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Numbers and places of the nodes, M and K (3 n, 3 n) with inner freedoms condensed."""
    if name == "rod":
        table, form = read_node_table(FILES / "rod/rod.inp", "INP"), "CCX"
        paths, mapping = [FILES / f"rod/rod.{end}" for end in ("mas", "sti")], FILES / "rod/rod.dof"
    else:
        table, form = read_node_table(FILES / f"{name}_nodes.txt", "TXT"), "MM"
        paths, mapping = [FILES / f"{name}_{letter}.mtx" for letter in "MK"], None
    found = []
    for letter, path in zip("MK", paths, strict=True):
        matrix = read_matrix(path, form, letter, mapping, mapping and form)
        whole = condensed(letter, matrix, table.numbers).matrix
        found.append(whole if isinstance(whole, np.ndarray) else whole.toarray())
    return table.numbers, table.positions, *found


def rounded(digits: int):
    """Return the function that rounds a matrix as an E format of so many significant digits does."""
    return np.vectorize(lambda value: float(f"{value:.{digits - 1}e}"))


def single(matrix: np.ndarray) -> np.ndarray:
    """Return the matrix in single precision."""
    return matrix.astype(np.float32).astype(float)


def noisy(matrix: np.ndarray) -> np.ndarray:
    """Return the symmetric matrix with noise in every entry."""
    noise = np.triu(NOISE * np.random.default_rng(0).normal(size=matrix.shape))
    return matrix * (1 + noise + np.triu(noise, 1).T)


def changes(digits: list[int]):
    """Name → (change of K, change of M)."""

    def same(matrix):
        return matrix

    found = {}
    for count in digits:
        found[f"K to {count} digits"] = rounded(count), same
        found[f"K, M to {count} digits"] = rounded(count), rounded(count)
    return {**found, "K, M in single": (single, single), "K with noise": (noisy, same)}


def frequencies(folder: Path, numbers, positions, M, K, frame) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, Hz, and the relative errors expected of them; empty where the body is refused."""
    files = [folder / f"{letter}.mtx" for letter in "MK"]
    for path, matrix in zip(files, (M, K), strict=True):
        mmwrite(path, coo_matrix(matrix), precision=17)
    given = FlexibleInput("body 1", *(FEFile(path, "MM") for path in files), numbers, positions, **frame)
    try:
        found, _ = flexible_body(replace(given, modes=MODES), cached=False)
    except ModelError:
        return np.zeros(0), np.zeros(0)
    return found.frequencies, found.frequency_errors


def main():
    """Print a row for every body and change, and the sum of all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--digits", nargs="+", type=int, default=[5, 6, 7, 8, 9, 10, 12])
    given = parser.parse_args()
    every = []
    print("body                      change              first off  expected  beyond  of  largest share")
    for title, (name, frame) in BODIES.items():
        numbers, positions, M, K = files_of(name)
        with tempfile.TemporaryDirectory() as folder:
            place = Path(folder), numbers, positions
            exact, _ = frequencies(*place, M, K, frame)
            for change, (of_stiffness, of_mass) in changes(given.digits).items():
                found, expected = frequencies(*place, of_mass(M), of_stiffness(K), frame)
                if not found.size:
                    print(f"{title:25} {change:18}  refused")
                    continue
                off = np.abs(found / exact - 1)
                share = (off / expected)[expected < LARGEST]
                every += share.tolist()
                print(
                    f"{title:25} {change:18} {off[0]:10.1e} {expected[0]:9.1e} {np.sum(share > 1):7d} "
                    f"{share.size:3d} {share.max(initial=0.0):14.2f}",
                    flush=True,
                )
    shares = np.array(every)
    print(
        f"{shares.size} frequencies: {100 * np.mean(shares > 1):.1f} % farther off than expected, the "
        f"farthest by {shares.max():.2f} times; root mean square {np.sqrt(np.mean(shares**2)):.2f}"
    )


if __name__ == "__main__":
    main()
