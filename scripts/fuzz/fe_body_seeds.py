"""Files of beams, shells, superelements, modes and couplings: seeds for damage."""

from pathlib import Path

import numpy as np

SUPERELEMENT = Path(__file__).resolve().parents[2] / "decks/vsdf/fe/beam_cb.pch"
SHELLS = """*NODE
1, 0., 0., 0.\n2, .3, 0., 0.\n3, .3, .2, 0.\n4, 0., .2, 0.
*ELEMENT, TYPE=S4, ELSET=P
1, 1, 2, 3, 4
*ELEMENT, TYPE=B31, ELSET=R
2, 1, 2
*ELEMENT, TYPE=B32, ELSET=R
3, 2, 3, 4
*SHELL SECTION, ELSET=P, MATERIAL=M
.01, 5
*BEAM SECTION, ELSET=R, MATERIAL=M, SECTION=RECT
.01, .02\n0., 0., 1.
*MATERIAL, NAME=M
*ELASTIC\n2e9, .3\n*DENSITY\n1000.
"""
BULK_SHELLS = """GRID,1,,0.,0.,0.\nGRID,2,,.3,0.,0.\nGRID,3,,.3,.2,0.\nGRID,4,,0.,.2,0.
CQUAD4,1,7,1,2,3,4\nPSHELL,7,1,.01,1,,1\nMAT1,1,2.+9,,.3,1000.
CBAR,2,8,1,2,0.,0.,1.\nPBAR,8,1,2.-4,1.-8,2.-8,1.-8
CBEAM,3,9,3,4,0.,0.,1.\nPBEAM,9,1,2.-4,1.-8,2.-8,,1.-8
"""
COUPLINGS = """*NSET, NSET=END\n5, 6, 7, 8
*NSET, NSET=ROOT\n1, 3, 4
*RIGID BODY, NSET=END, REF NODE=901
*ELEMENT, TYPE=DCOUP3D, ELSET=E\n77, 902
*DISTRIBUTING COUPLING, ELSET=E\nROOT, 2.
"""
BULK_COUPLINGS = "RBE2,7,901,123456,5,6,7,8\nRBE3,8,,902,123456,1.0,123,1,2\n,3,2.5,123,4\n"
EXTERNAL = """BEGIN SUPER 7
EXTRN          1  123456       2  123456       3  123456       4  123456
GRID,1,,0.,0.,0.\nGRID,2,,.1,0.,0.\nGRID,3,,.2,0.,0.\nGRID,4,,.3,0.,0.
"""


def body_files(nodes: np.ndarray, K: np.ndarray) -> dict[str, str]:
    """Contents by names; `nodes` (8, 3) and stiffness `K` (24, 24) are those of a brick."""
    grids = "".join(f"{n}, {x!r}, {y!r}, {z!r}\n" for n, (x, y, z) in enumerate(nodes.tolist(), start=1))
    bulk = "".join(f"GRID,{n},,{x!r},{y!r},{z!r}\n" for n, (x, y, z) in enumerate(nodes.tolist(), start=1))
    return {
        "s.inp": SHELLS,
        "s.bdf": BULK_SHELLS,
        "c.inp": f"*NODE\n{grids}901, .1, .1, .1\n902, .1, .1, 0.\n{COUPLINGS}",
        "c.bdf": f"BEGIN BULK\n{bulk}GRID,901,,.1,.1,.1\nGRID,902,,.1,.1,0.\n{BULK_COUPLINGS}ENDDATA\n",
        "e.pch": SUPERELEMENT.read_text(),
        "x.pch": EXTERNAL,
        "b.fem": modal_file(nodes - nodes.mean(axis=0), K),
    }


def beam_rows() -> tuple[np.ndarray, np.ndarray]:
    """M and K (24, 24) of three beams of Euler and Bernoulli in line along x, masses at the nodes."""
    L, K = 0.1, np.zeros((24, 24))
    bending = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]) * 20.0 / L**3
    lever = np.diag([1.0, L, 1.0, L])
    pair = np.array([[1.0, -1.0], [-1.0, 1.0]])
    parts = [((1, 5, 7, 11), lever), ((2, 4, 8, 10), lever * [1, -1, 1, -1])]  # θ_z = y', θ_y = -z'
    for k in range(3):
        for rows, factors in parts:
            K[np.ix_(*2 * [6 * k + np.array(rows)])] += factors @ bending @ factors
        for row, stiffness in ((0, 4e6), (3, 150.0)):
            K[np.ix_(*2 * [6 * k + np.array([row, 6 + row])])] += stiffness * pair
    return np.diag(4 * [0.05, 0.05, 0.05, 2e-5, 3e-5, 3e-5]), K


def modal_file(places: np.ndarray, K: np.ndarray) -> str:
    """A .fem file of MBDyn: four modes of the stiffness K with 0.75 kg at each place."""
    mass = 0.75
    values, shapes = np.linalg.eigh(K)
    still = "0 0 0 0\n"
    groups = [
        "** REV NODE NORMAL ATTACHMENT CONSTRAINT REJECTED\nREV0 8 4 0 0 0\n",
        "1 2 3 4 5 6 7 8\n",
        *2 * [still],
        *(" ".join(map(repr, column)) + "\n" for column in places.T.tolist()),
        "".join(f"** MODE {k - 5}\n{_lines(_with_turns(shapes[:, k]))}" for k in range(6, 10)),
        _lines(mass * np.eye(4)),
        _lines(np.diag(values[6:10])),
        _lines(np.outer(np.ones(8), [mass, mass, mass, 0, 0, 0])),
    ]
    return "** MBDyn MODAL DATA FILE\n" + "".join(
        f"** RECORD GROUP {number}, OF THE BRICK\n{group}" for number, group in enumerate(groups, start=1)
    )


def _with_turns(shape):
    return np.hstack([shape.reshape(8, 3), np.zeros((8, 3))])


def _lines(matrix):
    return "".join(" ".join(map(repr, row)) + "\n" for row in matrix.tolist())
