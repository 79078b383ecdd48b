"""The aluminium bar of tests/fe/formats/bar in the formats of other programs, and what `flexmb modes` says.

0.9 x 0.12 x 0.08 m, three bricks of mean dilatation, E 7e10 Pa, nu 0.33, 2700 kg/m3, consistent mass.
"""

import json
from pathlib import Path

import numpy as np
from click.testing import CliRunner
from scipy.io import mmread

from flexmb_cli.cli.modes import modes
from tests.fe.formats.test_op4_binary import Writer

FOLDER = Path(__file__).parent / "bar"
K, M = (mmread(FOLDER / f"{letter}.mtx").toarray() for letter in "KM")
NODES = (FOLDER / "nodes.txt").read_text()
MASS = 0.9 * 0.12 * 0.08 * 2700
FREQUENCIES = (1310.9663, 1332.9458, 1681.0752)  # Hz, of scipy.linalg.eigh(K, M), above the six of zero


def dmig(name, matrix, form=6, width=16, both=False, digits=None):
    """DMIG cards of nodes 1, 2, ... in fields of `width` columns; of form 9 columns 1, 2, ..."""
    star, columns = ("*", 2) if width == 16 else ("", 1)
    lines = [f"{'DMIG':8}{name:8}{0:8d}{form:8d}{columns:8d}{0:8d}"]
    digits = digits or (9 if width == 16 else 4)
    for j, numbers in enumerate(matrix.T):
        node, direction = (j // 3 + 1, j % 3 + 1) if form != 9 else (j + 1, 0)
        lines.append(f"{'DMIG' + star:8}{name:{width}}{node:{width}d}{direction:{width}d}")
        for i in np.flatnonzero(numbers):
            if form != 6 or both or i >= j:
                value = f"{numbers[i]:.{digits}E}" if width == 16 else eight(numbers[i])
                lines.append(f"{star:8}{i // 3 + 1:{width}d}{i % 3 + 1:{width}d}{value:>{width}}")
    return "\n".join(lines) + "\n"


def eight(value):
    """A number in eight columns, its exponent by a sign alone."""
    text = f"{value:.{3 if value < 0 else 4}E}"
    mantissa, exponent = text.split("E")
    return f"{mantissa}{int(exponent):+d}"


def op4_text(name, matrix, kind=2, form=2, blank=False):
    """A dense OP4 matrix as text; complex ones (kind 4) as pairs."""
    rows, columns = matrix.shape
    lines = [f"{columns:8d}{rows:8d}{form:8d}{kind:8d}{name:8}1P,3E23.16"]
    for j, numbers in enumerate(matrix.T, start=1):
        lines.append(f"{j:8d}{1:8d}{len(numbers) * 2:8d}")
        texts = [f"{value:23.16E}" for value in numbers]
        lines += ["".join(texts[i : i + 3]) for i in range(0, len(texts), 3)]
        if blank:
            lines.append("")
    lines += [f"{columns + 1:8d}{1:8d}{1:8d}", " 1.0000000000000000E+00", *[""] * blank]
    return "\n".join(lines) + "\n"


def op4_binary(*matrices):
    """Dense OP4 matrices, name and numbers; those of complex numbers are of type 4."""
    raw = b""
    for name, matrix in matrices:
        writer = Writer(kind=4 if np.iscomplexobj(matrix) else 2)
        writer.value = "d"
        rows, columns = matrix.shape
        raw += writer.heading(columns, rows, name.encode())
        for column, numbers in enumerate(matrix.T, start=1):
            numbers = np.ascontiguousarray(numbers).view(float)
            raw += writer.record((column, 1, writer.words(numbers)), writer.values(np.array(numbers)))
        raw += writer.end(columns)
    return raw


def market(matrix, between="", layout="coordinate", form=".17g"):
    """A Matrix Market file with `between` after the first and the tenth line of numbers."""
    rows, columns = np.indices(matrix.shape).reshape(2, -1)
    sizes = f"{len(matrix)} {len(matrix)}"
    if layout == "array":
        body = [f"{matrix[i, j]:.17g}" for j, i in zip(rows, columns, strict=True)]
    else:
        sizes += f" {matrix.size}"
        body = [f"{i + 1} {j + 1} {matrix[i, j]:{form}}" for i, j in zip(rows, columns, strict=True)]
    body = [body[0], *between, *body[1:10], *between, *body[10:]]
    return "\n".join([f"%%MatrixMarket matrix {layout} real general", sizes, *body]) + "\n"


def abaqus_rows(matrix, form=".17g"):
    """Row, column, value."""
    return "".join(f"{i + 1},{j + 1},{value:{form}}\n" for (i, j), value in np.ndenumerate(matrix))


def abaqus_nodes(matrix):
    """Row node, direction, column node, direction, value."""
    return "".join(
        f"{i // 3 + 1},{i % 3 + 1},{j // 3 + 1},{j % 3 + 1},{value:.17g}\n"
        for (i, j), value in np.ndenumerate(matrix)
        if i >= j
    )


def harwell_boeing(matrix, blank=False):
    """The full matrix (RUA) in fields of 25 columns, with blank lines between the numbers."""
    size, count = len(matrix), matrix.size
    pointers = [f"{k * size + 1:14d}" for k in range(size + 1)]
    indices = [f"{i + 1:14d}" for _ in range(size) for i in range(size)]
    values = [f"{value:25.16E}" for value in matrix.T.ravel()]
    gap = [""] * blank
    counts = [len(pointers), len(indices), len(values)]
    head = ["title", "".join(f"{n:14d}" for n in (sum(counts), *counts, 0))]
    head += [
        f"{'RUA':14}{size:14d}{size:14d}{count:14d}{0:14d}",
        f"{'(1I14)':16}{'(1I14)':16}{'(1E25.16)':20}",
    ]
    lines = [*head, *gap, *pointers, *gap, *indices[:7], *gap, *indices[7:], *values[:3], *gap, *values[3:]]
    return "\n".join(lines) + "\n"


def said(folder, mass, stiffness, mapping=None, cards="", nodes=NODES, form="TXT"):
    """What `flexmb modes --json` says of files given as format and content."""
    text = "VSDF x\nBODY\n1,FLEX,6\n"
    files = {"FEMN": (form, nodes), "FEMM": mass, "FEMK": stiffness, "FEMP": mapping}
    for word, (kind, content) in ((word, file) for word, file in files.items() if file):
        (folder / word).write_bytes(content if isinstance(content, bytes) else content.encode())
        text += f"{word}\n    1 {kind:4} {word}\n"
    (folder / "x.vsdf").write_text(f"{text}{cards}TIME\n0.01,0.005\nEND\nSTAR\nSTOP\n")
    return CliRunner().invoke(modes, [str(folder / "x.vsdf"), "--json"])


def bar_of(*arguments, **more):
    """Mass and the first three frequencies, Hz."""
    done = said(*arguments, **more)
    assert done.exit_code == 0, done.output
    (body,) = json.loads(done.stdout)["bodies"]
    return body["mass"], body["frequencies"][:3]


def refused(*arguments, **more):
    """The text of its errors."""
    done = said(*arguments, **more)
    assert done.exit_code == 2, done.output
    return done.output
