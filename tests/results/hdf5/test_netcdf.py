"""Results of every dialect and of studies are netCDF-4: other programs open them, and old ones stay readable.

The netCDF library looks for a dimension in the group of a variable and above it, never beside it (netCDF
User's Guide, Groups).  The files in `earlier` were written by the version of 2026-11-23 as "flexmb-1".
"""

import shutil
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.results.diff.compare import compare
from flexmb_cli.results.diff.tolerances import Tolerances
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck

EARLIER = Path(__file__).parent / "earlier"
DECKS = Path(__file__).resolve().parents[3] / "decks"
RUNS = {
    "kinematic": ("young/IN-RSSR.dat", "time.end=0.002"),
    "dynamic": ("young/dynamics/IN4-BAR-MASS.dat", "time.end=0.1"),
    "tree with loops": ("dafms/fourbar_rigid.DAT", "time.IT=4"),
    "flexible tree": ("dafms/two_link_n2.DAT", "time.IT=4"),
    "flexible mechanism": ("vsdf/slider_crank_flex.vsdf", "time.end=0.01"),
}
STUDY = f"""
deck = "{DECKS / "young/IN-RSSR.dat"}"
[parameters]
"driver.1.B" = [100.0, 150.0]
[results]
top = "max point.1.z"
z = "series point.1.z"
"""


@pytest.fixture(scope="module", params=[*RUNS, "study"])
def result(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    if request.param == "study":
        (folder / "s.toml").write_text(STUDY)
        path = folder / "s.h5"
        done = CliRunner().invoke(cli, ["sweep", str(folder / "s.toml"), "-o", str(path)])
        assert done.exit_code == 0, done.output
        return path
    deck, change = RUNS[request.param]
    outcome = run_deck(str(DECKS / deck), RunOptions(folder=str(folder), no_out=True, changes=(change,)))
    assert outcome.exit_code == 0, outcome.faults
    return next(folder.glob("*.h5"))


def numbers(path):
    """Arrays of numbers by path, as h5py reads them."""
    found = {}
    with h5py.File(path) as file:
        file.visititems(
            lambda name, item: found.update({name: item[()]})
            if isinstance(item, h5py.Dataset) and item.dtype.kind in "iuf" else None
        )  # fmt: skip
    return found


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_xarray_opens_the_whole_tree(result, engine):
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("netCDF4")
    expected = numbers(result)
    with xarray.open_datatree(result, engine=engine, decode_times=False) as tree:
        for path, values in expected.items():
            found = tree[f"/{path}"]
            assert np.array_equal(found.values, values), path
            assert not any("phony" in str(name) for name in found.dims), path


def test_netcdf4_and_ncdump_open_it(result):
    netcdf = pytest.importorskip("netCDF4")
    with netcdf.Dataset(result) as file:
        for path, values in numbers(result).items():
            assert np.array_equal(np.ma.getdata(file[f"/{path}"][...]), values), path
    if shutil.which("ncdump"):
        done = subprocess.run(["ncdump", str(result)], capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, "")


def test_every_scale_lies_in_the_group_of_its_datasets_or_above(result):
    with h5py.File(result) as file:
        assert file.attrs["Conventions"] in ("flexmb-2", "flexmb-study-2")

        def look(name, item):
            if not isinstance(item, h5py.Dataset) or item.is_scale:
                return
            for axis in item.dims:
                assert len(axis) == 1, name
                folder = axis[0].name.rpartition("/")[0]
                assert f"/{name}".startswith(f"{folder}/"), (name, axis[0].name)

        file.visititems(look)


COMMANDS = {
    "table": ["table", "{}", "*", "--format", "text"],
    "list": ["table", "{}", "--list"],
    "csv": ["export", "{}", "--to", "csv", "-o", "{}.csv"],
    "mat": ["export", "{}", "--to", "mat", "-o", "{}.mat"],
    "vtkhdf": ["export", "{}", "--to", "vtkhdf", "-o", "{}.vtkhdf"],
    "plot": ["plot", "{}", "-o", "{}.svg"],
    "report": ["report", "{}", "-o", "{}.html"],
    "diff": ["diff", "{}", "{}"],
}


# Words of quantities that results did not have yet when those of the folder `earlier` were written.
ADDED = ("rate", "cell", "hinge", "coordinate")


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("name", ["fourbar_rigid", "slider_crank_flex"])
def test_every_command_reads_an_earlier_result(tmp_path, name, command):
    path = shutil.copy(EARLIER / f"{name}.h5", tmp_path)
    done = CliRunner().invoke(cli, [word.format(path) for word in COMMANDS[command]])
    assert done.exit_code == 0, (done.output, done.exception)


def test_an_earlier_table_of_a_study_is_read():
    path = str(EARLIER / "study.h5")
    for arguments in (
        ["table", path],
        ["table", path, "z", "top"],
        ["table", path, "--list"],
        ["diff", path, path],
    ):
        assert CliRunner().invoke(cli, arguments).exit_code == 0
    reported = CliRunner().invoke(cli, ["table", path, "driver.1.B"]).output.splitlines()
    assert [line.split(",")[1] for line in reported[1:3]] == ["100.0", "150.0"]


@pytest.mark.parametrize("name", ["fourbar_rigid", "slider_crank_flex"])
def test_quantities_have_the_same_names_in_results_of_both_numbers(tmp_path, name):
    """The names of joints are found by the copied scale, too; scales that only one has are no difference.

    Later results of bodies with elements hold these, and the rates of the modes.
    """
    deck, change = next(run for run in RUNS.values() if name in run[0])
    run_deck(str(DECKS / deck), RunOptions(folder=str(tmp_path), no_out=True, changes=(change,)))
    both = [str(EARLIER / f"{name}.h5"), str(tmp_path / f"{name}.h5")]
    listed = [CliRunner().invoke(cli, ["table", path, "--list"]).output.replace(path, "") for path in both]
    earlier, later = ([line.split() for line in text.splitlines()] for text in listed)
    added = [line for line in later if line not in earlier]
    assert [line for line in earlier if line not in later] == [] and "reaction" in listed[0]
    news = [line for line in added if not any(word in name.split(".") for name in line for word in ADDED)]
    assert not news, "what is meant to be new goes into ADDED here"
    report = compare(*both, Tolerances(atol=1e-8, rtol=1e-6))
    assert all(any(word in one for word in ADDED) for one in map(str, report.missing)), report.missing
