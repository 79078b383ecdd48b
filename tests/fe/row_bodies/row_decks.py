"""Decks of bodies with rotations, bodies made of them, and motions of other programs to compare with."""

from pathlib import Path

import numpy as np

from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.dialects.vsdf.reader import read_vsdf
from flexmb_cli.fe.flexible_bodies import flexible_body
from tests.fe.trusses import write_matrix

HERE = Path(__file__).parent
DECKS = HERE.parents[2] / "decks/vsdf"
FILES = HERE.parent / "formats/reduced"
FREE = """VSDF one body
BODY
    1,FLEX,{modes},
FEMN
    1,{nodes}
FEMM
    1,{mass}
FEMK
    1,{stiffness}
{more}TIME
    {time}
INTG
    RAD5,1e-10
END
STAR
STOP
"""


def free_deck(folder, nodes, mass, stiffness, more="", modes=0, time="0.1,0.1,0.0"):
    """The text of a deck with one body, its files in `folder`."""
    files = {"nodes": nodes, "mass": mass, "stiffness": stiffness}
    files = {key: text.replace(" ", f",{folder}/") for key, text in files.items()}
    return FREE.format(more=more, modes=modes, time=time, **files)


def body_of(text, folder=HERE):
    """The first flexible body of a deck's text and the faults that were warnings."""
    model, _ = build_vsdf(read_vsdf(DeckText("x.vsdf", text, "")), folder)
    given = next(body.flexible for body in model.bodies if body.flexible)
    return flexible_body(given, cached=False)


def market_deck(folder, positions, M, K, numbers=(), **more):
    """A deck of one body whose matrices are given, files written to `folder`."""
    numbers = numbers or range(1, len(positions) + 1)
    rows = zip(numbers, positions, strict=True)
    (folder / "nodes.txt").write_text("".join(f"{n} {x[0]:.17g} {x[1]:.17g} {x[2]:.17g}\n" for n, x in rows))
    write_matrix(folder / "M.mtx", M)
    write_matrix(folder / "K.mtx", K)
    return free_deck(folder, "TXT nodes.txt", "MM M.mtx", "MM K.mtx", **more)


def motion(name):
    """Columns of a motion of another program: times, places and rotation vectors."""
    rows = np.loadtxt(HERE / f"{name}.csv", delimiter=",")
    return rows[:, 0], rows[:, 1:4], rows[:, 4:7]


def rotation(vectors):
    """Rotation matrices (k, 3, 3) of rotation vectors (k, 3)."""
    found = []
    for v in vectors:
        x = np.linalg.norm(v)
        skew = np.cross(np.eye(3), v)
        found.append(np.eye(3) + np.sinc(x / np.pi) * skew + np.sinc(x / 2 / np.pi) ** 2 / 2 * skew @ skew)
    return np.array(found)
