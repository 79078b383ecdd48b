"""STL files: both kinds give the same surface; damaged, empty and huge ones are refused in words.

3D Systems (1988): binary is 80 bytes of title, a 32-bit count, 50 bytes a triangle.
"""

import struct

import numpy as np
import pytest

from flexmb_cli.fe.formats import stl
from flexmb_cli.fe.formats.matrix_file import FEFileFault

# A tetrahedron with edges along the axes: volume 1/6, seen anticlockwise from outside.
CORNERS = ((0, 0, 0), (2, 0, 0), (0, 3, 0), (0, 0, 4))
FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))


def binary(faces=FACES, title=b"solid by a writer that begins so", count=None):
    body = b"".join(
        struct.pack("<12fH", 0, 0, 0, *(x for k in face for x in CORNERS[k]), 7) for face in faces
    )
    return title.ljust(80) + struct.pack("<I", len(faces) if count is None else count) + body


def text(faces=FACES):
    facets = "".join(
        " facet normal 0 0 0\n  outer loop\n"
        + "".join("   vertex {} {:.1f} {:E}\n".format(*CORNERS[k]) for k in face)
        + "  endloop\n endfacet\n"
        for face in faces
    )
    return f"solid wedge\n{facets}endsolid wedge\n".encode()


def volume(vertices, triangles):
    """By the divergence theorem."""
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    return float(np.sum(a * np.cross(b, c)) / 6)


@pytest.mark.parametrize(
    "content", [binary(), text(), text().replace(b"\n", b"\r\n"), b"\n" + text(), text().upper()]
)
def test_text_and_binary_give_the_closed_surface(tmp_path, content):
    (tmp_path / "part.stl").write_bytes(content)
    vertices, triangles = stl.read_stl(tmp_path / "part.stl")
    assert sorted(map(tuple, vertices)) == sorted(CORNERS)
    assert len(triangles) == 4
    assert volume(vertices, triangles) == pytest.approx(2 * 3 * 4 / 6, rel=1e-15)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "is not an STL file"),
        (binary()[:-1], r"84 \+ 50 × 4 bytes for the 4 triangles that it announces; it has 283"),
        (binary(count=2**32 - 1), "84 .* 4294967295 triangles"),
        (binary(faces=()), "has no triangles"),
        (binary(faces=((1, 1, 2),)), "no triangle whose corners differ"),
        (binary().replace(struct.pack("<f", 3.0), struct.pack("<f", np.nan)), "not finite"),
        (text()[:-20], "does not end with 'endsolid'"),
        (text().replace(b"vertex", b"vortex", 1), "11 corners and 4 triangles"),
        (text().replace(b"4.000000E+00", b"4.0O"), "a corner that is not a number: it reads 4.0O$"),
        (text().replace(b"4.000000E+00", b"\xff" * 90), "it reads \ufffd{40}$"),
        (text().replace(b"4.000000E+00", b"1e999"), "not finite"),
        (b"\xff" * 10_000, "is not an STL file"),
    ],
)
def test_damaged_files_are_refused(tmp_path, content, words):
    (tmp_path / "part.stl").write_bytes(content)
    with pytest.raises(FEFileFault, match=words) as reported:
        stl.read_stl(tmp_path / "part.stl")
    assert str(reported.value).startswith("part.stl") and reported.value.id


def test_a_file_that_is_missing_or_too_large_is_refused(tmp_path, monkeypatch):
    with pytest.raises(FEFileFault, match="no such file"):
        stl.read_stl(tmp_path / "none.stl")
    (tmp_path / "huge.stl").write_bytes(b"")
    with open(tmp_path / "huge.stl", "r+b") as file:
        file.truncate(2**27)  # a hole: nothing is written
    with pytest.raises(FEFileFault, match="larger than the 128 MB"):
        stl.read_stl(tmp_path / "huge.stl")
    monkeypatch.setattr(stl, "MOST_TRIANGLES", 3)
    for content in (binary(), text()):
        (tmp_path / "part.stl").write_bytes(content)
        with pytest.raises(FEFileFault, match="4 triangles; at most 3"):
            stl.read_stl(tmp_path / "part.stl")
