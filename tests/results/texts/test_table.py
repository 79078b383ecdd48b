"""Quantities of a result as text."""

import csv
import io
import json
import os
import subprocess
import sys
import tracemalloc

import h5py
import numpy as np
import pytest

from flexmb_cli.results.quantities.quantities import open_result, resolve
from flexmb_cli.results.quantities.table import FORMATS, chosen_rows, list_text, table_text
from tests.results.results import value, write_result


@pytest.fixture
def path(tmp_path):
    return write_result(tmp_path / "r.h5", 9)


def text(path, names, style="csv", start=None, stop=None, every=1):
    with open_result(path) as file:
        return "".join(table_text(file, resolve(file, names), chosen_rows(file, start, stop, every), style))


def expected(rows):
    """Columns time, body.3.z, coordinate.5 at rows, from the closed rule of `results.value`."""
    return [[0.25 * row, value("body/position", row, 2, 2), value("coordinate/q", row, 4)] for row in rows]


NAMES = ["body.3.z", "coordinate.5"]
HEADS = ["time [s]", "body.3.z [m]", "coordinate.5 [m]"]


@pytest.mark.parametrize(("style", "delimiter"), [("csv", ","), ("tsv", "\t")])
def test_separated_values_come_back_to_the_last_bit(path, style, delimiter):
    heads, *rows = csv.reader(io.StringIO(text(path, NAMES, style)), delimiter=delimiter)
    assert heads == HEADS
    assert [[float(cell) for cell in row] for row in rows] == expected(range(9))


def test_json_lines_come_back_to_the_last_bit(path):
    records = [json.loads(line) for line in text(path, NAMES, "jsonl").splitlines()]
    assert [list(record) for record in records] == 9 * [HEADS]
    assert [list(record.values()) for record in records] == expected(range(9))


def test_aligned_columns_end_below_their_heads(path):
    heads, *rows = text(path, NAMES, "text").splitlines()
    ends = [heads.index(head) + len(head) for head in HEADS]
    for row, numbers in zip(rows, expected(range(9)), strict=True):
        assert len(row) == ends[-1]
        cells = [row[start:end] for start, end in zip([0, *ends], ends, strict=False)]
        assert [float(cell) for cell in cells] == pytest.approx(numbers, rel=1e-8)


@pytest.mark.parametrize(
    ("window", "rows"),
    [
        ({}, range(9)),
        ({"every": 4}, (0, 4, 8)),
        ({"start": 0.5}, range(2, 9)),
        ({"stop": 0.5}, range(3)),
        ({"start": 0.5000000001, "stop": 1.2499999999}, range(2, 6)),
        ({"start": 0.6, "stop": 1.9, "every": 2}, (3, 5, 7)),
        ({"start": 5.0}, ()),
        ({"start": 1.0, "stop": 0.5}, ()),
        ({"stop": -1.0}, ()),
    ],
)
def test_windows_and_steps_choose_rows(path, window, rows):
    lines = text(path, NAMES, **window).splitlines()[1:]
    assert [[float(cell) for cell in line.split(",")] for line in lines] == expected(rows)


def test_the_time_stands_first_and_once(path):
    assert text(path, ["energy.total", "time"]).splitlines()[0] == "time [s],energy.total [J]"


@pytest.mark.parametrize("style", FORMATS)
def test_numbers_that_are_none_are_told(tmp_path, style):
    path = write_result(tmp_path / "n.h5", 3)
    with h5py.File(path, "a") as file:
        file["energy/total"][1] = np.nan
    line = text(path, ["energy.total"], style).splitlines()[-2]
    assert "null" in line if style == "jsonl" else line.endswith("nan")


def test_the_list_tells_name_unit_and_meaning(path):
    with open_result(path) as file:
        quantities = resolve(file, ["reaction.3.force.x", "energy.total"])
    assert list_text(quantities).splitlines() == [
        "reaction.3.force.x  N  revolute 2: force on body J",
        "energy.total        J  total energy",
    ]
    record = json.loads(list_text(quantities, "jsonl").splitlines()[1])
    assert record == {"name": "energy.total", "unit": "J", "meaning": "total energy"}


def test_memory_does_not_grow_with_the_rows(tmp_path):
    def peak(rows):
        path = write_result(tmp_path / f"{rows}.h5", rows)
        tracemalloc.start()
        with open_result(path) as file:
            for _ in table_text(file, resolve(file, ["energy.total"]), chosen_rows(file, None, None, 1)):
                pass
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    assert peak(80000) < 1.5 * peak(20000)


def flexmb(*arguments, cwd):
    return subprocess.run(
        [sys.executable, "-m", "flexmb_cli", *map(str, arguments)],
        cwd=cwd, capture_output=True, text=True, encoding="utf-8", timeout=60,
    )  # fmt: skip


def test_the_command_prints_the_table_and_nothing_else(path):
    done = flexmb("table", path, "body.3.z", "coordinate.5", "--from", "0.5", "--every", "3", cwd=path.parent)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == text(path, NAMES, start=0.5, every=3)


def test_a_reader_that_leaves_ends_the_command_quietly(tmp_path):
    path = write_result(tmp_path / "r.h5", 30000)
    command = f"{sys.executable} -m flexmb_cli table {path} body | head -1"
    done = subprocess.run(command, shell=True, capture_output=True, text=True, timeout=60)
    assert done.stdout.startswith("time [s],")
    assert done.stdout.count(os.linesep) == 1
    assert done.stderr == ""


def test_a_failed_run_is_remarked_on_standard_error(tmp_path):
    path = write_result(tmp_path / "r.h5", 3, "failed", "at t = 0.6 s the loop cannot close")
    done = flexmb("table", path, "energy.total", cwd=tmp_path)
    assert done.returncode == 0
    assert len(done.stdout.splitlines()) == 4
    note = "the run is not complete, its rows end at t = 0.5 s: at t = 0.6 s the loop cannot close"
    assert done.stderr == f"{path}: note: {note}\n"
    assert flexmb("table", path, "energy.total", "-q", cwd=tmp_path).stderr == ""


def test_a_result_without_rows_gives_the_heads(tmp_path):
    path = write_result(tmp_path / "r.h5", 0, "failed", "cannot be assembled")
    done = flexmb("table", path, "energy.total", cwd=tmp_path)
    assert done.stdout == "time [s],energy.total [J]\n"
    note = "the run is not complete, it has no rows: cannot be assembled"
    assert done.stderr == f"{path}: note: {note}\n"


def test_a_window_without_rows_is_remarked(path):
    done = flexmb("table", path, "energy.total", "--from", "9", cwd=path.parent)
    assert (done.returncode, done.stdout) == (0, "time [s],energy.total [J]\n")
    assert done.stderr == f"{path}: note: it has no rows in this window of time\n"


def test_wrong_use_is_refused(path):
    for arguments, message in (
        ([path], "name at least one quantity"),
        ([path, "body.9.z"], f"{path}: error: body.9.z: the result has no such quantity"),
        ([path, ""], f"{path}: error: an empty name: the result has no such quantity"),
        ([path, "--list", "--from", "0"], "--list shows names, not rows: --from, --to and --every do not go"),
        ([path, "--list", "--every", "2"], "--list shows names, not rows"),
        (["none.h5", "time"], "none.h5: error: no such file"),
        (["none.h5"], "none.h5: error: no such file"),
        ([path, "time", "--every", "0"], "--every"),
        ([path, "time", "--from", "nan"], "nan is not a finite number"),
    ):
        done = flexmb("table", *arguments, cwd=path.parent)
        assert (done.returncode, done.stdout) == (2, "")
        assert message in done.stderr


def test_a_file_damaged_in_the_middle_is_told(tmp_path):
    """The trees that find the chunks of rows (nodes of type 1, HDF5 file format III.A.1) are spoiled."""
    path = write_result(tmp_path / "r.h5", 5000)
    path.write_bytes(path.read_bytes().replace(b"TREE\x01", b"LOST\x01"))
    for window in ([], ["--from", "0.5"]):
        done = flexmb("table", path, "energy.total", *window, cwd=tmp_path)
        assert done.returncode == 2
        assert "cannot be read" in done.stderr
        assert "Traceback" not in done.stderr
