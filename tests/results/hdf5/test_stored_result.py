"""HDF5 results that strangers may have made: refused in words before anything else is read."""

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.results.hdf5 import stored_result
from tests.growth import LINEAR, growth
from tests.results.results import write_result

COMMANDS = {
    "table": ["table", "{result}", "--list"],
    "diff": ["diff", "{intact}", "{result}", "--same-attitude"],
    "csv": ["export", "{result}", "--to", "csv", "-o", "{folder}/x"],
    "vtkhdf": ["export", "{result}", "--to", "vtkhdf", "-o", "{folder}/x"],
    "report": ["report", "{result}", "-o", "{folder}/x"],
}


def said(tmp_path, command, damage):
    """Exit code and message of a command on a result that `damage` changed."""
    intact, result = (write_result(tmp_path / f"{name}.h5", 5) for name in ("intact", "r"))
    with h5py.File(result, "r+") as file:
        damage(file)
    arguments = [word.format(result=result, intact=intact, folder=tmp_path) for word in COMMANDS[command]]
    done = CliRunner().invoke(cli, arguments)
    error = done.exception
    return getattr(error, "exit_code", done.exit_code), done.output + str(error)


def replaced(path, **making):
    def damage(file):
        del file[path]
        file.create_dataset(path, **making)

    return damage


def linked(link):
    def damage(file):
        del file["time"]
        file["time"] = link

    return damage


def of_other_file(file):
    del file["energy/total"]
    layout = h5py.VirtualLayout(shape=(5,), dtype="f8")
    layout[...] = h5py.VirtualSource("intact.h5", "time", shape=(5,))
    file.create_virtual_dataset("energy/total", layout)


def deep(file):
    file.create_group("/".join(200 * ["a"]))


def filtered(file):
    """Filter 305 is none of the library: it would be looked for among the plugins on the disk."""
    del file["energy/total"]
    plan = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    plan.set_chunk((5,))
    plan.set_filter(305, h5py.h5z.FLAG_OPTIONAL)
    space, kind = h5py.h5s.create_simple((5,)), h5py.h5t.NATIVE_DOUBLE
    h5py.h5d.create(file["energy"].id, b"total", kind, space, plan)


EVERYWHERE = {
    "a link into another file": (linked(h5py.ExternalLink("intact.h5", "/time")), "link"),
    "a link to a device": (linked(h5py.ExternalLink("/dev/zero", "/time")), "link"),
    "a link by name": (linked(h5py.SoftLink("/energy/total")), "link"),
    "numbers in a device": (
        replaced("time", shape=(5,), dtype="f8", external=[("/dev/zero", 0, h5py.h5f.UNLIMITED)]),
        "another file",
    ),
    "numbers in another result": (of_other_file, "another file"),
    "a filter from the disk": (filtered, "filter"),
    "a million million rows": (replaced("time", shape=(10**12,), chunks=(1024,), dtype="f8"), "declares"),
    "more bytes than an integer counts": (
        replaced("time", shape=(2**40, 2**40), chunks=(16, 16), dtype="f8"),
        "declares",
    ),
    "chunks of gigabytes of zeros": (
        replaced("time", shape=(5,), maxshape=(None,), chunks=(2**28,), dtype="f8", compression="gzip"),
        "declares",
    ),
    "groups in groups": (deep, "deep"),
    "a type of its own": (replaced("time", shape=(5,), dtype=[("a", "f8")]), "neither numbers nor text"),
    "nothing": (replaced("time", data=h5py.Empty("f8")), "is empty"),
    # A fault of flexmb in `diff`.
    "a name in another encoding": (
        lambda file: file.create_dataset(b"body/\xe9t\xe9", data=np.zeros(5)),
        "is not UTF-8",
    ),
}


@pytest.mark.parametrize("case", EVERYWHERE)
@pytest.mark.parametrize("command", ["table", "diff"])
def test_a_file_that_no_run_leaves_is_refused_before_it_is_read(tmp_path, command, case):
    damage, reported = EVERYWHERE[case]
    code, message = said(tmp_path, command, damage)
    assert code == 2
    assert reported in message


def scale_removed(file):
    """The HDF5 library ends the process when it is asked for a scale that was removed."""
    del file["xyz"]


FITTING = {
    "a scale that was removed": ("table", scale_removed, "a damaged result"),
    "names that are numbers": ("table", replaced("body/name", data=np.arange(3.0)), "not a list of names"),
    "fewer names than bodies": ("table", replaced("body/name", data=["a"]), "1 names for 3 things"),
    "attitudes of three parameters": (
        "vtkhdf", replaced("body/euler_parameters", data=np.ones((5, 3, 3))), "axis of 4",
    ),
    "a joint on a body that is not there": (
        "vtkhdf", lambda file: file.create_dataset("joint/body", data=[[0, 9]] * 4), "outside 0..3",
    ),
    "a joint on half a body": (
        "vtkhdf", lambda file: file.create_dataset("joint/body", data=[[0.0, 1.0]] * 4), "no whole numbers",
    ),
    "attitudes of another shape": (
        "diff", replaced("body/euler_parameters", data=np.ones((5, 2))), "not an array of 3 axes",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", FITTING)
def test_parts_that_do_not_fit_together_are_told(tmp_path, case):
    command, damage, reported = FITTING[case]
    code, message = said(tmp_path, command, damage)
    assert code == 2
    assert reported in message


@pytest.mark.parametrize("status", [7, [1.0, 2.0], b"\xff\xfe", h5py.Empty("f8")], ids=str)
def test_a_status_that_is_no_text_counts_as_not_complete(tmp_path, status):
    code, message = said(tmp_path, "csv", lambda file: file.attrs.__setitem__("status", status))
    assert code == 0
    assert "the run is not complete" in message


def test_names_in_a_file_do_not_command_the_terminal(tmp_path):
    def damage(file):
        file["body/name"][0] = "\x1b[2J\u202egone"
        file["time"].attrs["long_name"] = "\x1b]0;title\x07"
        file.attrs["message"] = "\x9b2J"
        file.attrs["status"] = "failed"

    for command in ("table", "csv"):
        code, message = said(tmp_path, command, damage)
        assert code == 0
        assert not set("\x1b\u202e\x07\x9b") & set(message)


def test_a_compressed_copy_of_a_result_is_read(tmp_path):
    """h5repack and netCDF tools compress: the bound on declared sizes leaves them room."""
    path = tmp_path / "r.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("time", data=np.zeros(10**6), compression="gzip")
    with h5py.File(path) as file:
        stored_result.check_structure(file)
        assert file["time"].nbytes > 100 * path.stat().st_size


def test_series_are_listed_in_time_in_proportion_to_their_number(tmp_path):
    """HDF5 looks through the file for the name of what a reference leads to: 30 s for a thousand series."""

    def result_of(count):
        def add(file):
            for k in range(count):
                series = file.create_dataset(f"body/more {k}", data=file["time"][:])
                series.dims[0].attach_scale(file["time"])

        folder = tmp_path / str(count)
        folder.mkdir()
        assert said(folder, "table", add)[0] == 0
        return folder / "r.h5"

    results = {count: result_of(count) for count in (100, 400)}

    def listed(count):
        done = CliRunner().invoke(cli, ["table", str(results[count]), "--list"])
        assert "body.1.x" in done.output

    assert growth(listed, 100) < LINEAR


def test_a_name_beyond_the_names_of_its_group_is_told(tmp_path):
    """h5py's own visit of links looks each up, and ends in a SystemError where that fails."""
    result = tmp_path / "r.h5"
    with h5py.File(result, "w") as file:
        file["time"], file["body/body"], file["body/name"] = [0.0, 0.1], [1, 2], ["a", "b"]
    raw = result.read_bytes()
    # A node of symbols: a heading of 8 bytes, then entries of 40, each beginning with the place of its name.
    nodes = [k for k in range(len(raw) - 4) if raw[k : k + 4] == b"SNOD"]
    assert len(nodes) == 2
    for place in [node + 8 + 40 * entry for node in nodes for entry in (0, 1)]:
        result.write_bytes(raw[:place] + b"\xff\xff" + raw[place + 2 :])
        done = CliRunner().invoke(cli, ["table", str(result), "--list"])
        assert getattr(done.exception, "exit_code", None) == 2, done.exception
        assert "r.h5: " in done.output + str(done.exception)


@pytest.mark.parametrize("length", [0, 8, 2**63, 10**6])
def test_a_heap_whose_free_space_has_no_size_is_told(tmp_path, length):
    """HDF5 1.14 goes round in it for ever: texts and references cannot be read."""
    result = tmp_path / "r.h5"
    with h5py.File(result, "w") as file:
        file["time"], file["body/name"] = [0.0, 0.1], ["a", "b"]
    raw = result.read_bytes()
    # Heading of 16 bytes; "a" and "b" in parts of a heading and 8 bytes each; free space, its length at +8.
    start = raw.index(b"GCOL")
    free = start + 16 + 2 * 24
    assert raw[free : free + 2] == b"\0\0"
    assert int.from_bytes(raw[free + 8 : free + 16], "little") == 4096 - 64
    result.write_bytes(raw[: free + 8] + length.to_bytes(8, "little") + raw[free + 16 :])
    done = CliRunner().invoke(cli, ["table", str(result), "--list"])
    assert getattr(done.exception, "exit_code", None) == 2, done.exception
    assert f"the heap at byte {start} has a part of {length} bytes" in str(done.exception)


def test_a_text_like_the_head_of_a_heap_is_a_text(tmp_path):
    """It lies within a heap; each is walked through once, so that a hundred thousand cost no more."""

    def result_of(count):
        result = write_result(tmp_path / f"{count}.h5", 5)
        with h5py.File(result, "r+") as file:
            file["more"] = count * "GCOL\x01"
            file.attrs["message"] = "GCOL\x01 in a sentence"
        assert result.read_bytes().count(b"GCOL\x01") > count
        return result

    results = {count: result_of(count) for count in (25_000, 100_000)}

    def listed(count):
        done = CliRunner().invoke(cli, ["table", str(results[count]), "--list"])
        assert done.exit_code == 0, done.output

    assert growth(listed, 25_000) < LINEAR


def test_numbers_of_a_kind_that_numpy_lacks_are_told(tmp_path):
    """A float with a bias of its own, which h5py refuses by a ValueError; found by fuzzing."""

    def damage(file):
        kind = h5py.h5t.IEEE_F64LE.copy()
        kind.set_ebias(99_999)
        h5py.h5d.create(file.id, b"more", kind, h5py.h5s.create_simple((2,)))

    code, reported = said(tmp_path, "table", damage)
    assert code == 2
    assert "/more holds neither numbers nor text" in reported


@pytest.mark.parametrize("error", [ValueError, TypeError, SystemError, UnicodeError])
def test_what_h5py_raises_of_a_damaged_structure_is_told(tmp_path, monkeypatch, error):
    """It reads HDF5's messages as UTF-8, also where they quote a name that is none; found by fuzzing."""

    def visit(*_, **__):
        raise error("quoted \x1b[2J")

    monkeypatch.setattr(stored_result, "fault_of_heaps", visit)
    code, reported = said(tmp_path, "table", lambda file: None)
    assert code == 2
    assert "its structure cannot be read: quoted " in reported
    assert "\x1b" not in reported
