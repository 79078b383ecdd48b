"""An aluminium bar of three bricks, 0.9 x 0.12 x 0.08 m: 16 nodes, its files, and what they must give.

E 7e10 Pa, nu 0.33, 2700 kg/m3; bar/Ka.mtx and Ma.mtx are matrices of own bricks (mean dilatation, consistent
mass).  Frequencies of theirs and of fully integrated bricks by `scipy.linalg.eigh`.
"""

import itertools
from pathlib import Path

from flexmb_cli.errors import ModelError
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.fe.formats.formats import OF_ELEMENTS
from flexmb_cli.fe.formats.node_table import read_node_table
from flexmb_cli.model.flexible_body import ElementMaterial, FEFile, FlexibleInput

BAR = Path(__file__).parent / "bar"
MASS = 23.328  # kg
OF_MATRICES = [1310.9663, 1332.9458, 1681.0752]  # Hz
FULLY_INTEGRATED = [1390.2774, 1485.3317, 1681.4442]  # Hz
# Nodes 1 to 16 along z, then y, then x.
POINTS = [
    (0.3 * i, 0.12 * j, 0.08 * k) for i, j, k in itertools.product(range(4), range(2), range(2))
]  # fmt: skip
BRICKS = [[1 + 4 * i + n for n in (0, 4, 6, 2, 1, 5, 7, 3)] for i in range(3)]


def inp_nodes(first=1, last=16, points=POINTS):
    return "".join(f"{n}, {', '.join(map(repr, points[n - 1]))}\n" for n in range(first, last + 1))


def inp_elements(type="C3D8"):
    rows = "".join(f"{n}, {', '.join(map(str, nodes))}\n" for n, nodes in enumerate(BRICKS, 1))
    return f"*ELEMENT, TYPE={type}, ELSET=EALL\n{rows}"


def bdf_nodes(first=1, last=16, points=POINTS, system=""):
    return "".join(
        f"GRID,{n},{system},{','.join(map(repr, points[n - 1]))}\n" for n in range(first, last + 1)
    )


def bdf_elements():
    rows = [[n, 1, *nodes] for n, nodes in enumerate(BRICKS, 1)]
    return "".join(f"CHEXA,{','.join(map(str, row[:8]))}\n,{row[8]},{row[9]}\n" for row in rows)


def nblock(first=1, last=16, key="SOLID"):
    rows = "".join(
        f"{n:9d}{0:9d}{0:9d}" + "".join(f"{x:21.13e}" for x in POINTS[n - 1]) + "\n"
        for n in range(first, last + 1)
    )
    return f"NBLOCK,6,{key},{last:9d},{last:9d}\n(3i9,6e21.13e3)\n{rows}N,R5.3,LOC,       -1,\n"


def eblock(rows, type=1, key="SOLID"):
    """Rows of numbers and nodes."""
    text = "".join(
        "".join(f"{word:9d}" for word in [1, type, 1, 1, 0, 0, 0, 0, len(nodes), 0, number, *nodes]) + "\n"
        for number, nodes in rows
    )
    return f"EBLOCK,19,{key},{len(rows):9d},{len(rows):9d}\n(19i9)\n{text}       -1\n"


def by_matrices(folder, form, text, modes=3):
    """The reduced body of the bar's matrices beside a node table of `text`."""
    (folder / "nodes").write_text(text)
    table = read_node_table(folder / "nodes", form)
    given = FlexibleInput(
        "body 1", FEFile(BAR / "Ma.mtx", "ABQ"), FEFile(BAR / "Ka.mtx", "ABQ"), table.numbers,
        table.positions,
        modes=modes,
    )  # fmt: skip
    return flexible_body(given, cached=False)[0]


def by_elements(folder, form, text):
    """The reduced body of the elements of `text`, and the warnings."""
    (folder / "mesh").write_text(text)
    path = folder / "mesh"
    table, elements = read_node_table(path, form), FEFile(path, OF_ELEMENTS)
    material = ElementMaterial(FEFile(path, form), 7e10, 0.33, None, 2700.0, program="CCX")
    given = FlexibleInput(
        "body 1", elements, elements, table.numbers, table.positions, modes=3, material=material
    )
    body, faults = flexible_body(given, cached=False)
    return body, [fault.message for fault in faults]


def refusal(make, *arguments):
    """The sentences of a body that is refused."""
    try:
        make(*arguments)
    except ModelError as stopped:
        return [fault.message for fault in stopped.faults]
    raise AssertionError("it was not refused")
