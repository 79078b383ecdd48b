"""Finite-element files by their grammar, with hostile values: a file and the reader that is to get it."""

import struct

from fe_readers import op4_record
from grammars import HOSTILE_INTEGERS, disordered, mostly, reals, small
from hypothesis import strategies as st

sizes = mostly(st.integers(1, 3), st.sampled_from(HOSTILE_INTEGERS))
indices = mostly(st.integers(1, 3), st.sampled_from(HOSTILE_INTEGERS))
INT32 = mostly(st.integers(0, 4), st.sampled_from((-1, 2**31 - 1, -(2**31), 65536, 2**24, 65537)))


@st.composite
def finite_element_files(draw) -> tuple[str, bytes]:
    """Name of the reader, and the bytes of a file in its format."""
    reader = draw(st.sampled_from(sorted(GRAMMARS)))
    made = GRAMMARS[reader](draw)
    raw = made if isinstance(made, bytes) else ("\n".join(disordered(draw, made)) + "\n").encode()
    return draw(mostly(st.just(reader), st.sampled_from(sorted(GRAMMARS)))), raw


def _rows(draw, *columns, separator=" ", most=5):
    return [
        separator.join(str(draw(column)) for column in columns) for _ in range(draw(st.integers(0, most)))
    ]


def _matrix_market(draw):
    layout = draw(st.sampled_from(("coordinate", "array")))
    words = [draw(st.sampled_from(("real", "integer"))), draw(st.sampled_from(("general", "symmetric")))]
    entries = (indices, indices, reals) if layout == "coordinate" else (reals,)
    lines = _rows(draw, *entries)
    n = draw(sizes)
    size = [n, draw(mostly(st.just(n), sizes))]
    if layout == "coordinate":
        size.append(draw(mostly(st.just(len(lines)), sizes)))
    return [
        f"%%MatrixMarket matrix {layout} {' '.join(words)}",
        "% comment",
        " ".join(map(str, size)),
        *lines,
    ]


def _abaqus(draw):
    wide = draw(st.booleans())
    return _rows(draw, *([indices] * (4 if wide else 2)), reals, separator=",")


def _calculix(draw):
    return _rows(draw, indices, indices, reals, most=12)


def _dofs(draw):
    return _rows(draw, st.builds("{}.{}".format, indices, mostly(st.integers(1, 3), st.integers(0, 9))))


def _mapping(draw):
    dofs = st.sampled_from(("UX", "UY", "UZ", "ux", "ROTX"))
    return ["   Matrix Eqn   Node   DOF", *_rows(draw, indices, indices, mostly(dofs, st.just("P")))]


def _harwell_boeing(draw):
    lengths = [draw(mostly(st.just(n), sizes)) for n in (3, 2, 2)]
    head = [sum(lengths), *lengths, draw(mostly(st.just(0), sizes))]
    size = [draw(mostly(st.just(n), sizes)) for n in (2, 2, 2, 0)]
    kind = draw(st.sampled_from(("RSA", "RUA", "RSA", "PSA")))
    formats = [
        draw(st.sampled_from(("(1I14)", "(8I10)", "(I1)", "(I999)", "(0I0)", "(99999999I1)"))),
        draw(st.sampled_from(("(1I14)", "(I2)"))),
        draw(st.sampled_from(("(1D25.15)", "(1P,4E20.12)", "(E1.0)", "(D0)"))),
    ]
    cells = st.lists(indices, min_size=1, max_size=4)
    wide = [" ".join(f"{n:14d}" for n in draw(cells)) for _ in range(5)]
    return [
        "brick",
        "".join(f"{n:14d}" for n in head),
        f"{kind}{'':11}" + "".join(f"{n:14d}" for n in size),
        f"{formats[0]:16}{formats[1]:16}{formats[2]:20}",
        *wide,
        *(draw(reals).rjust(25) for _ in range(2)),
    ]


def _bulk(draw, name, *fields):
    """A card in small fields, in large ones, or by commas, continued as it must be."""
    texts = [str(draw(field)) for field in fields]
    form = draw(st.integers(0, 2))
    if form == 2:
        return [",".join([name, *texts[:8]]), *([",".join(["+", *texts[8:]])] if texts[8:] else [])]
    width, count, mark = ((8, 8, ""), (16, 4, "*"))[form]
    pieces = [texts[k : k + count] for k in range(0, len(texts), count)]
    heads = [f"{name}{mark}", *([mark or "+"] * (len(pieces) - 1))]
    return [
        f"{head:8}" + "".join(text.rjust(width)[:width] for text in piece)
        for head, piece in zip(heads, pieces, strict=True)
    ]


def _dmig(draw):
    lines = []
    for name in draw(st.lists(st.sampled_from(("KAAX", "MAAX", "K")), min_size=1, max_size=2)):
        forms = mostly(st.sampled_from((6, 1, 2)), small), mostly(st.sampled_from((1, 2)), small)
        lines += _bulk(draw, "DMIG", st.just(name), st.just(0), *forms, st.just(0))
        for _ in range(draw(st.integers(0, 3))):
            entry = (indices, indices, reals, st.just(""))
            entries = draw(st.integers(1, 3)) * entry
            lines += _bulk(draw, "DMIG", st.just(name), indices, indices, st.just(""), *entries)
    return lines


def _op4_text(draw):
    n = draw(sizes)
    head = [f"{n:8d}{draw(mostly(st.just(n), sizes)):8d}{6:8d}{draw(mostly(st.just(2), small)):8d}"]
    head[0] += f"{'K':8}{draw(mostly(st.just('1P,3E23.16'), st.sampled_from(('1P,3E0', 'E999', 'I5', ''))))}"
    lines = []
    for column in range(1, draw(st.integers(0, 3)) + 1):
        first = draw(mostly(st.just(1), small))
        lines.append(f"{draw(mostly(st.just(column), indices)):8d}{first:8d}{draw(small):8d}")
        if not first:
            lines.append(" ".join(str(draw(indices)) for _ in range(draw(st.integers(1, 2)))))
        lines.append(
            "".join(draw(mostly(st.just("1.0"), reals)).rjust(23) for _ in range(draw(st.integers(1, 3))))
        )
    return [*head, *lines, f"{draw(mostly(st.just(n + 1), indices)):8d}{1:8d}{2:8d}", f"{1.0:23.16E}"]


def _op4_binary(draw):
    order = draw(st.sampled_from("<>"))
    n = draw(INT32)
    head = [n, draw(mostly(st.just(n), INT32)), 6, draw(mostly(st.just(2), INT32))]
    raw = op4_record(head, b"KAAX    ", order)
    for column in range(1, draw(st.integers(0, 3)) + 1):
        values = struct.pack(f"{order}3d", 1.0, draw(st.floats()), -2.0)
        inner = [draw(mostly(st.just(k), INT32)) for k in (column, 1, 6)]
        packed = [draw(mostly(st.just(65536 * 7 + 1), INT32))] if draw(st.booleans()) else []
        reported = draw(mostly(st.none(), INT32))
        raw += op4_record([*inner, *packed], values, order, reported)
    end = [draw(mostly(st.just(n + 1), INT32)), 1, 2]
    return raw + (op4_record([min(max(k, -(2**31)), 2**31 - 1) for k in end], bytes(8), order))


def _nodes_txt(draw):
    return _rows(draw, indices, reals, reals, reals)


def _nodes_inp(draw):
    types = st.sampled_from(("C3D8", "C3D20", "C3D8R", "C3D4", ""))
    nodes = ["*NODE", *_rows(draw, indices, reals, reals, reals, separator=", ")]
    bricks = [
        f"*ELEMENT, TYPE={draw(types)}",
        *_rows(draw, *([st.integers(1, 9)] * 9), indices, separator=","),
    ]
    return [*nodes, *bricks, "*STEP"]


def _nodes_bdf(draw):
    lines = ["BEGIN BULK"]
    for _ in range(draw(st.integers(0, 4))):
        lines += _bulk(draw, "GRID", indices, st.just(""), reals, reals, reals)
    for name in draw(st.lists(mostly(st.just("CHEXA"), st.just("CTETRA")), max_size=2)):
        nodes = draw(st.sampled_from((8, 20, 4))) * (mostly(st.integers(1, 30), small),)
        lines += _bulk(draw, name, indices, indices, *nodes)
    return lines


def _nodes_cdb(draw):
    layouts = (
        "(3i9,6e20.13)",
        "(3i8,6e16.9)",
        "(1i9,1e1.0)",
        "(999i999,1e9.9)",
        "(0i0,0e0)",
        "(3i99999,6e20)",
    )
    lines = ["NBLOCK,6,SOLID,8,8", draw(st.sampled_from(layouts))]
    for _ in range(draw(st.integers(0, 3))):
        lines.append(f"{draw(indices):9d}{0:9d}{0:9d}" + "".join(draw(reals).rjust(20) for _ in range(3)))
    lines += [
        "N,R5.3,LOC,-1,",
        "EBLOCK,19,SOLID,1,1",
        draw(st.sampled_from(("(19i9)", "(19i1)", "(19i0)", "(9)"))),
    ]
    for _ in range(draw(st.integers(0, 2))):
        head = [1, 1, 1, 1, 0, 0, 0, 0, draw(mostly(st.just(8), indices)), 0, draw(indices)]
        lines.append("".join(f"{n:9d}" for n in [*head, *(draw(indices) for _ in range(8))]))
    return [*lines, draw(mostly(st.just("       -1"), st.just("")))]


def _modal(draw):
    """A .fem file of MBDyn: record groups of about as many numbers as they need."""
    n, modes = draw(sizes), draw(sizes)
    lines = ["** RECORD GROUP 1,HEADER", f"REV0 {n} {modes} 0 0 {draw(mostly(st.just(0), small))}"]
    for group, count in ((2, 1), (5, 1), (6, 1), (7, 1), (8, 6), (9, 1), (10, 1), (11, 6), (12, 13)):
        values = indices if group == 2 else reals
        numbers = [str(draw(values)) for _ in range(min(abs(count * n * (modes if group > 7 else 1)), 30))]
        lines += [f"** RECORD GROUP {draw(mostly(st.just(group), small))},", " ".join(numbers)]
    return lines


def _user_element(draw):
    """A substructure of Abaqus, or of CalculiX, which names a node for every row."""
    n = draw(sizes)
    lines = [f"*USER ELEMENT, NODES={n}, LINEAR", "** ELEMENT NODES"]
    lines += ["** " + ", ".join(str(draw(indices)) for _ in range(draw(st.integers(0, 3))))]
    words = st.sampled_from(("1, 2, 3", "1", "2, 2", "3, 4, 5, 6", "1, 7", "x"))
    lines += [draw(words) for _ in range(draw(st.integers(1, 3)))]
    for kind in draw(st.lists(st.sampled_from(("STIFFNESS", "MASS", "DAMPING")), max_size=2)):
        lines += [f"*MATRIX,TYPE={kind}", *_rows(draw, reals, reals, separator=",")]
    return lines


def _order(draw):
    components = mostly(st.sampled_from(("123456", "0", "2", "")), small)
    return [*_bulk(draw, "EXTRN", *(draw(st.integers(1, 5)) * (indices, components))), *_nodes_bdf(draw)]


def _couplings_bdf(draw):
    components = mostly(st.sampled_from(("123456", "123")), small)
    rigid = (indices, indices, components, *(draw(st.integers(0, 7)) * (indices,)))
    mean = (indices, st.just(""), indices, components, reals, components, indices, reals, components, indices)
    return [*_bulk(draw, "RBE2", *rigid), *_bulk(draw, "RBE3", *mean), *_nodes_bdf(draw)]


def _couplings_inp(draw):
    name = st.sampled_from(("N", "M", "1", "x"))
    keywords = (
        "*RIGID BODY, NSET=N, REF NODE=1",
        "*KINEMATIC COUPLING, REF NODE=1",
        "*ELEMENT, TYPE=DCOUP3D, ELSET=E",
        "*DISTRIBUTING COUPLING, ELSET=E",
        "*COUPLING, REF NODE=1",
        "*NSET, NSET=N",
        "*NSET, NSET=M, GENERATE",
    )
    lines = []
    for keyword in draw(st.lists(st.sampled_from(keywords), max_size=5)):
        lines += [keyword, *_rows(draw, mostly(indices, name), indices, indices, separator=",", most=2)]
    return lines


GRAMMARS = {
    "matrix MM": _matrix_market,
    "matrix ABQ": lambda draw: (_abaqus if draw(st.booleans()) else _user_element)(draw),
    "matrix DMIG": _dmig,
    "matrix OP4": lambda draw: (_op4_text if draw(st.booleans()) else _op4_binary)(draw),
    "mapping ANS": _mapping,
    "mapping CCX": _dofs,
    "mapping BDF": _order,
    "couplings BDF": _couplings_bdf,
    "couplings INP": _couplings_inp,
    "nodes TXT": _nodes_txt,
    "nodes FEM": _modal,
    "matrix FEM": _modal,
    **{f"{what} INP": _nodes_inp for what in ("nodes", "bricks")},
    **{f"{what} BDF": _nodes_bdf for what in ("nodes", "bricks")},
    **{f"{what} CDB": _nodes_cdb for what in ("nodes", "bricks")},
}
