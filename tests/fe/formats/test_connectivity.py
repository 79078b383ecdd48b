"""Solid elements in the files of node tables, and what is said of other elements."""

import pytest

from flexmb_cli.fe.formats.connectivity import read_elements
from flexmb_cli.fe.formats.matrix_file import FEFileFault

EIGHT = list(range(11, 19))
TWENTY = list(range(1, 21))
# CHEXA has the edges from the lower to the upper face as G13 to G16, Abaqus and ANSYS as nodes 17 to 20.
NASTRAN = [*range(1, 13), *range(17, 21), *range(13, 17)]


def cdb(nodes):
    """An EBLOCK of (19i9): eleven integers and eight nodes, the other nodes on a second line."""
    words = [1, 1, 1, 1, 0, 0, 0, 0, len(nodes), 0, 5, *nodes]
    lines = ["".join(f"{word:9d}" for word in part) for part in (words[:19], words[19:]) if part]
    return "\n".join(["EBLOCK,19,SOLID,  1,  1", "(19i9)", *lines, "       -1"]) + "\n"


FILES = {
    "INP 8": (
        "*NODE\n1, 0, 0, 0\n*Element, type=C3D8I, elset=E\n5, 11, 12, 13, 14, 15, 16, 17, 18\n*STEP\n1\n",
        EIGHT,
    ),
    "INP 20": (
        "*ELEMENT, ELSET=E, TYPE=C3D20R\n5, "
        + ", ".join(map(str, TWENTY[:15]))
        + ",\n** note\n16,17,18,19,20\n",
        TWENTY,
    ),
    "CDB 8": (cdb(EIGHT), EIGHT),
    "CDB 20": (cdb(TWENTY), TWENTY),
    "INP 4": ("*ELEMENT, TYPE=C3D4\n5, 1, 2, 3, 4\n", TWENTY[:4]),
    "INP 10": ("*ELEMENT, TYPE=C3D10\n5, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10\n", TWENTY[:10]),
    "CDB 10": (cdb(TWENTY[:10]), TWENTY[:10]),
    "BDF 4": ("CTETRA,5,1,1,2,3,4\n", TWENTY[:4]),
    "BDF 10": ("CTETRA,5,1,1,2,3,4,5,6\n,7,8,9,10\n", TWENTY[:10]),
    "BDF 8": ("CHEXA,5,1,11,12,13,14,15,16\n,17,18\n", EIGHT),
    "BDF 20": (
        "CHEXA   5       1       "
        + "".join(f"{node:<8d}" for node in NASTRAN[:6])
        + "+\n+       "
        + "".join(f"{node:<8d}" for node in NASTRAN[6:14])
        + "+\n+       "
        + "".join(f"{node:<8d}" for node in NASTRAN[14:])
        + "\n",
        TWENTY,
    ),
}


@pytest.mark.parametrize("kind", FILES)
def test_every_format_gives_the_nodes_in_one_order(tmp_path, kind):
    text, wanted = FILES[kind]
    (tmp_path / "x").write_text(text)
    found = read_elements(tmp_path / "x", kind.split()[0])
    assert found.numbers.tolist() == [5]
    assert found.nodes.tolist() == [wanted]


def test_the_type_is_that_of_elements_not_of_a_keyword_without_any(tmp_path):
    """Nor of the keyword *ELEMENT OUTPUT."""
    text = "*ELEMENT OUTPUT, TYPE=C3D8\n*ELEMENT, TYPE=C3D20\n" + FILES["INP 20"][0]
    (tmp_path / "x").write_text(text)
    assert read_elements(tmp_path / "x", "INP").kind == "C3D20R"


REFUSED = {
    "a shell": (
        "INP",
        "*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n",
        "x holds no elements in format INP but 1 S4; tetrahedra of 4 or 10 and hexahedra of 8 or 20 nodes",
    ),
    "a wedge": (
        "BDF",
        "CPENTA,3,1,1,2,3,4,5,6\n",
        "x, line 1: CPENTA 3: stresses are computed for tetrahedra",
    ),
    "a brick with a node twice": (
        "CDB",
        cdb([11, 12, 13, 13, 15, 16, 17, 17]),
        "x, line 3: element 5 has not the different nodes of one of the tetrahedra",
    ),
    "too few nodes": (
        "BDF",
        "CHEXA,5,1,11,12,13,14,15,16\n,17\n",
        "x, line 1: element 5 has not the different nodes",
    ),
    "a mixture": (
        "INP",
        "".join(FILES[kind][0] for kind in ("INP 8", "INP 20")),
        "x mixes elements of 8 and of 20 nodes",
    ),
    "two types of as many nodes": (
        "INP",
        FILES["INP 20"][0] + FILES["INP 20"][0].replace("C3D20R", "C3D20").replace("5, ", "6, ", 1),
        "x mixes elements of types C3D20 and C3D20R; use one type",
    ),
    "an element twice": (
        "INP",
        "*ELEMENT, TYPE=C3D4\n7, 1, 2, 3, 4\n8, 2, 3, 4, 5\n*ELEMENT, TYPE=C3D4\n7, 1, 2, 3, 4\n",
        "x: element 7 stands on lines 2 and 5",
    ),
    "a card twice": (
        "BDF",
        "CTETRA,5,1,1,2,3,4\nCTETRA,5,1,2,3,4,6\n",
        "x: element 5 stands on lines 1 and 2",
    ),
    "a row of EBLOCK twice": (
        "CDB",
        "\n".join([*cdb(EIGHT).splitlines()[:3], *cdb(EIGHT).splitlines()[2:]]),
        "x: element 5 stands on lines 3 and 4",
    ),
    "a word": (
        "INP",
        "*ELEMENT, TYPE=C3D8\n1, 2, 3, four, 5, 6, 7, 8, 9\n",
        "x, line 2: expected whole numbers",
    ),
    "none": ("INP", "*NODE\n1, 0, 0, 0\n", "x holds no elements in format INP"),
    "a table of nodes": (
        "TXT",
        "1 0 0 0\n",
        "a node table of format TXT has no elements; INP, CDB or BDF has",
    ),
    "a block cut off": ("CDB", cdb(EIGHT)[:-12], "x: EBLOCK does not end with -1"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_used_is_told_with_its_line(tmp_path, case):
    form, text, message = REFUSED[case]
    (tmp_path / "x").write_text(text)
    with pytest.raises(FEFileFault, match="x") as refused:
        read_elements(tmp_path / "x", form)
    assert message in str(refused.value)
