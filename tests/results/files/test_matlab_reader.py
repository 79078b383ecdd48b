"""MATLAB files read back: as scipy reads those of flexmb, and without harm where they are damaged."""

import io
import struct

import numpy as np
import pytest
from scipy.io import loadmat, savemat

from flexmb_cli.results.files.matlab import read_variable
from tests.results.results import write_result

CONTENT = {
    "position": np.arange(24.0).reshape(2, 3, 4),
    "count": np.arange(3, dtype=np.int32),
    "one": 2.5,
    "names": np.array(["body 1", "", "Ärm"], dtype=object),
    "deck": "DFMB\n µ",
    "inner": {"x": np.array([[1, 2]], dtype=np.uint8), "nothing": np.zeros((0, 3))},
}


def saved(content, **how):
    stream = io.BytesIO()
    savemat(stream, {"flexmb": content}, long_field_names=True, oned_as="column", **how)
    return stream.getvalue()


def test_a_struct_is_what_scipy_reads():
    raw = saved(CONTENT)
    expected = loadmat(io.BytesIO(raw), simplify_cells=False)["flexmb"][0, 0]
    found = read_variable(raw, "flexmb")
    assert list(found) == list(CONTENT) == list(expected.dtype.names)
    for name in ("position", "count", "one"):
        assert found[name].dtype == expected[name].dtype
        np.testing.assert_array_equal(found[name], expected[name])
    assert (found["names"], found["deck"]) == (["body 1", "", "Ärm"], "DFMB\n µ")
    assert (found["inner"]["x"].tolist(), found["inner"]["nothing"].shape) == ([[1, 2]], (0, 3))


@pytest.mark.parametrize("content", [1.0, "text", np.array([1 + 2j])], ids=["number", "text", "complex"])
def test_what_flexmb_does_not_write_is_refused(content):
    with pytest.raises(ValueError, match=r"no struct flexmb|is none that flexmb writes"):
        read_variable(saved(content), "flexmb")


def test_compressed_files_are_refused_and_never_unpacked():
    """A megabyte of them can be a gigabyte."""
    with pytest.raises(ValueError, match="an element of type 15"):
        read_variable(saved(CONTENT, do_compression=True), "flexmb")


def test_every_length_that_is_not_true_is_refused():
    """scipy allocated gigabytes, or crashed, where a length or a type was changed; found by fuzzing."""
    raw = saved(CONTENT)
    sound = 0
    for at in range(128, len(raw), 4):
        for value in (0, 1, 15, 2**16 + 1, 2**31 - 1, 2**32 - 8):
            try:
                read_variable(raw[:at] + struct.pack("<I", value) + raw[at + 4 :], "flexmb")
                sound += 1
            except ValueError:
                continue
    assert sound > 0  # numbers and letters may be any


def test_a_file_that_ends_early_is_refused():
    raw = saved(CONTENT)
    for end in range(0, len(raw) - 8, 7):
        with pytest.raises(ValueError, match=r"."):
            read_variable(raw[:end], "flexmb")


def test_structs_without_end_are_refused():
    content = {"x": 1.0}
    for _ in range(40):
        content = {"s": content}
    with pytest.raises(ValueError, match="nested deeper than 32"):
        read_variable(saved(content), "flexmb")


def test_diff_refuses_a_damaged_file_in_words(tmp_path):
    """The length of an array was 2 GB; the program ended with signal 11 for others."""
    from click.testing import CliRunner

    from flexmb_cli.cli import cli

    result = write_result(tmp_path / "r.h5", 3)
    CliRunner().invoke(cli, ["export", str(result), "--to", "mat", "-o", str(tmp_path / "r.mat")])
    raw = bytearray((tmp_path / "r.mat").read_bytes())
    assert CliRunner().invoke(cli, ["diff", str(tmp_path / "r.mat"), str(result)]).exit_code == 0
    raw[132:136] = struct.pack("<I", 2**31 - 1)
    (tmp_path / "r.mat").write_bytes(raw)
    done = CliRunner().invoke(cli, ["diff", str(tmp_path / "r.mat"), str(result)])
    assert done.exit_code == 2
    assert (
        "no MATLAB file that flexmb wrote can be read from it: an element is longer than"
        in str(done.exception) + done.output
    )
