"""Small bodies as files of every finite-element format, and the decks that name them: seeds for damage.

One brick, a plate of shells with beams at its edges, a beam of rows with rotations, modes, and couplings.
"""

import struct
from pathlib import Path

import numpy as np
from fe_body_seeds import beam_rows, body_files

YOUNG, POISSON, DENSITY = 2e9, 0.3, 1000.0
SIDES = (0.3, 0.2, 0.1)
UNIT = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
XYZ = ("UX", "UY", "UZ")
STIFFENED, OF_MESH = "GEOS\n    1    1     2e+09       0.3\n", "MATL\n    1     2e+09       0.3    1000.0\n"
COUPLED = "RBE2\n    1  901    0\nRBE3\n    1  902    0\n"
# Name of the deck: formats and files of the cards FEMN, FEMM, FEMK, FEMP, and further cards.
DECKS = {
    "mm": ("TXT n.txt", "MM m.mtx", "MM k.mtx", "", ""),
    "mm_array": ("CDB n.cdb", "MM m.array", "MM k.array", "", STIFFENED),
    "hb": ("TXT n.txt", "HB m.hb", "HB k.hb", "ANS n.mapping", ""),
    "ccx": ("INP n.inp", "CCX n.mas", "CCX n.sti", "CCX n.dof", STIFFENED),
    "abaqus": ("INP n.inp", "ABQ m.abq", "ABQ k.abq", "", ""),
    "abaqus_rows": ("TXT n.txt", "ABQ m.coo", "ABQ k.coo", "", ""),
    "dmig": ("BDF n.bdf", "DMIG mk.pch", "DMIG mk.pch", "", STIFFENED),
    "op4": ("BDF n.bdf", "OP4 mk.op4", "OP4 mk.op4", "", ""),
    "op4_binary": ("TXT n.txt", "OP4 mk.bin", "OP4 mk.bin", "", ""),
    "shells_inp": ("INP s.inp", "", "", "", OF_MESH),
    "shells_bdf": ("BDF s.bdf", "", "", "", OF_MESH),
    "couplings_inp": ("INP c.inp", "ABQ m.abq", "ABQ k.abq", "", COUPLED),
    "couplings_bdf": ("BDF c.bdf", "DMIG mk.pch", "DMIG mk.pch", "", COUPLED),
    "superelement": ("BDF e.pch", "DMIG e.pch", "DMIG e.pch", "", ""),
    "rotations_op4": ("BDF x.pch", "OP4 r.op4", "OP4 r.op4", "BDF x.pch", ""),
    "modal": ("FEM b.fem", "FEM b.fem", "FEM b.fem", "", ""),
}


def write_seeds(folder: Path) -> dict[str, list[str]]:
    """Write decks and files into `folder`; the names of each deck's files, by the deck's name."""
    nodes, M, K = _brick()
    files = _node_files(nodes) | _matrix_files(M, K) | body_files(nodes, K)
    for name, content in files.items():
        raw = content if isinstance(content, bytes) else content.encode()
        (folder / name).write_bytes(raw)
    for name, (*cards, more) in DECKS.items():
        (folder / f"{name}.vsdf").write_text(_deck(cards, more))
    return files_of_decks()


def files_of_decks() -> dict[str, list[str]]:
    """The names of each deck's files, by the deck's name."""
    return {
        f"{name}.vsdf": sorted({card.split()[1] for card in cards if card})
        for name, (*cards, _) in DECKS.items()
    }


def _brick():
    """Positions (8, 3), mass of equal points with neighbours coupled, stiffness of a brick C3D8."""
    nodes = UNIT * SIDES
    K = _stiffness(nodes)
    near = (np.abs(UNIT[:, None] - UNIT[None]).sum(axis=2)).astype(int)
    # Consistent mass of a box: 8 4 2 1 parts of 216 for nodes that share a corner, an edge, a face, nothing.
    m = DENSITY * np.prod(SIDES) / 216 * np.array([8, 4, 2, 1])[near]
    return nodes, np.kron(m, np.eye(3)), K


def _stiffness(nodes):
    """Trilinear displacements, two points along each side (Hughes 2000, section 3.5)."""
    signs, K = 2 * UNIT - 1, np.zeros((24, 24))
    shear = YOUNG / (2 * (1 + POISSON))
    D = np.diag([2 * shear] * 3 + [shear] * 3)
    D[:3, :3] += 2 * shear * POISSON / (1 - 2 * POISSON)
    for point in signs / np.sqrt(3):
        ends = 1 + signs * point
        slopes = np.stack([signs[:, i] * np.delete(ends, i, axis=1).prod(axis=1) / 8 for i in range(3)])
        jacobian = slopes @ nodes
        x, y, z = np.linalg.solve(jacobian, slopes)
        B = np.zeros((6, 8, 3))
        B[0, :, 0], B[1, :, 1], B[2, :, 2] = x, y, z
        B[3, :, 0], B[3, :, 1] = y, x
        B[4, :, 1], B[4, :, 2] = z, y
        B[5, :, 2], B[5, :, 0] = x, z
        B = B.reshape(6, 24)
        K += B.T @ D @ B * np.linalg.det(jacobian)
    return K


def _deck(cards, more):
    lines = ["VSDF A BRICK", "BODY", "    1 FLEX    4    0    0    0"]
    for word, card in zip(("FEMN", "FEMM", "FEMK", "FEMP"), cards, strict=True):
        if card:
            form, file = card.split()
            lines += [word, f"    1 {form:4} {file}"]
    lines += [*more.splitlines(), "TIME", "      0.01     0.001"]
    if cards[0].split()[1].startswith("n."):
        lines += ["JOIN", "    1 REVO    0    0    0    1    1    2", "OUTN", "    1    7"]
    return "\n".join([*lines, "END", "STAR", "STOP"]) + "\n"


def _node_files(nodes):
    rows = list(enumerate(nodes, start=1))
    corner = list(range(1, 9))
    integers = "".join(f"{n:9d}" for n in (1, 1, 1, 1, 0, 0, 0, 0, 8, 0, 1, *corner))
    cdb = ["/PREP7", "NBLOCK,6,SOLID,8,8", "(3i9,6e20.13)"]
    cdb += [f"{n:9d}{0:9d}{0:9d}" + "".join(f"{x:20.13E}" for x in r) for n, r in rows]
    cdb += ["N,R5.3,LOC,-1,", "EBLOCK,19,SOLID,1,1", "(19i9)", integers, "       -1", "FINISH"]
    inp = ["*NODE", *(f"{n}, {r[0]}, {r[1]}, {r[2]}" for n, r in rows)]
    inp += ["*ELEMENT, TYPE=C3D8", ", ".join(map(str, (1, *corner))), "*STEP"]
    bdf = ["BEGIN BULK", *(f"GRID,{n},,{r[0]},{r[1]},{r[2]}" for n, r in rows)]
    bdf += ["CHEXA,1,1,1,2,3,4,5,6", "+,7,8", "ENDDATA"]
    mapping = ["   Matrix Eqn   Node   DOF"]
    mapping += [f"{3 * n + k + 1:12d}{n + 1:8d}  {XYZ[k]}" for n in range(8) for k in range(3)]
    texts = {
        "n.txt": [f"{n} {r[0]} {r[1]} {r[2]}" for n, r in rows],
        "n.cdb": cdb,
        "n.inp": inp,
        "n.bdf": bdf,
    }
    texts |= {"n.mapping": mapping, "n.dof": [f"{n}.{k}" for n in range(1, 9) for k in (1, 2, 3)]}
    return {name: "\n".join(lines) + "\n" for name, lines in texts.items()}


def _matrix_files(M, K):
    files = {}
    for letter, matrix in (("m", M), ("k", K)):
        lower = [(i, j, matrix[i, j]) for j in range(24) for i in range(j, 24) if matrix[i, j]]
        head = f"%%MatrixMarket matrix coordinate real symmetric\n24 24 {len(lower)}\n"
        files[f"{letter}.mtx"] = head + "".join(f"{i + 1} {j + 1} {v!r}\n" for i, j, v in _plain(lower))
        values = "".join(f"{v!r}\n" for v in matrix.T.ravel().tolist())
        files[f"{letter}.array"] = f"%%MatrixMarket matrix array real general\n24 24\n{values}"
        files[f"{letter}.hb"] = _harwell_boeing(lower)
        files[f"n.{'mas' if letter == 'm' else 'sti'}"] = "".join(
            f"{j + 1} {i + 1} {v!r}\n" for i, j, v in _plain(lower)
        )
        files[f"{letter}.abq"] = "".join(
            f"{i // 3 + 1},{i % 3 + 1}, {j // 3 + 1},{j % 3 + 1}, {v!r}\n" for i, j, v in _plain(lower)
        )
        files[f"{letter}.coo"] = "".join(f"{i + 1}, {j + 1}, {v!r}\n" for i, j, v in _plain(lower))
    named = (("KAAX", K), ("MAAX", M))
    files["mk.pch"] = "".join(_dmig(name, matrix) for name, matrix in named)
    files["mk.op4"] = "".join(_op4(name, matrix) for name, matrix in named)
    rows = zip(("MXX", "KXX"), beam_rows(), strict=True)
    files["r.op4"] = "".join(_op4(name, matrix) for name, matrix in rows)
    files["mk.bin"] = b"".join(_op4_binary(name, matrix) for name, matrix in named)
    return files


def _plain(entries):
    return [(i, j, float(value)) for i, j, value in entries]


def _harwell_boeing(lower):
    counts = [sum(j == column for _, j, _ in lower) for column in range(24)]
    pointers = np.concatenate([[1], 1 + np.cumsum(counts)]).tolist()
    head = [
        f"{'brick':72}BRICK",
        "".join(f"{n:14d}" for n in (25 + 2 * len(lower), 25, *[len(lower)] * 2, 0)),
    ]
    head += [f"RSA{'':11}" + "".join(f"{n:14d}" for n in (24, 24, len(lower), 0))]
    head += [f"{'(1I14)':16}{'(1I14)':16}{'(1D25.15)':20}"]
    numbers = [f"{n:14d}" for n in pointers] + [f"{i + 1:14d}" for i, _, _ in lower]
    numbers += [f"{v:25.15E}".replace("E", "D") for _, _, v in lower]
    return "\n".join(head + numbers) + "\n"


def _dmig(name, matrix):
    lines = [f"DMIG    {name:8}{0:8d}{6:8d}{2:8d}{0:8d}"]
    for j in range(24):
        lines.append(f"DMIG*   {name:16}{j // 3 + 1:16d}{j % 3 + 1:16d}")
        for i in range(j, 24):
            value = f"{matrix[i, j]:.8E}".replace("E", "D")
            lines.append(f"*       {i // 3 + 1:16d}{i % 3 + 1:16d}{value:>16}")
    return "\n".join(lines) + "\n"


def _op4(name, matrix):
    lines = [f"{24:8d}{24:8d}{6:8d}{2:8d}{name:8}1P,3E23.16"]
    for j in range(24):
        lines.append(f"{j + 1:8d}{1:8d}{48:8d}")
        cells = [f"{value:23.16E}" for value in matrix[:, j]]
        lines += ["".join(cells[k : k + 3]) for k in range(0, 24, 3)]
    return "\n".join([*lines, f"{25:8d}{1:8d}{2:8d}", f"{1.0:23.16E}"]) + "\n"


def _op4_binary(name, matrix):
    def record(integers, payload=b""):
        body = struct.pack(f"<{len(integers)}i", *integers) + payload
        return struct.pack("<i", len(body)) + body + struct.pack("<i", len(body))

    columns = [record((j + 1, 1, 48), matrix[:, j].astype("<f8").tobytes()) for j in range(24)]
    heading = record((24, 24, 6, 2), name.ljust(8).encode())
    return b"".join([heading, *columns, record((25, 1, 2), struct.pack("<d", 1.0))])
