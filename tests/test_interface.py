"""The Python interface: motions in memory are those of closed forms and of the files of `flexmb run`."""

import gc
import html
import re
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

import flexmb_cli
from flexmb_cli import (
    AnalysisError,
    DeckError,
    FlexmbError,
    ModelError,
    Result,
    check,
    interface,
    read_deck,
    solve,
    sweep,
)
from flexmb_cli.cli import cli
from flexmb_cli.cli.run import run
from flexmb_cli.run.outcome import RunOptions
from tests.solvers.kinematics.test_kinematic_trouble import slider_crank

DECKS = Path(__file__).resolve().parents[1] / "decks"
FOUR_BAR = DECKS / "young/IN4-BAR.dat"


def test_the_crank_turns_as_its_driver_says():
    """Point 1 sits 2 m along z of the crank, which turns about x: z = 2 cos(B t)."""
    result = solve(read_deck(FOUR_BAR, changes={"driver.1.B": 3.0}))
    assert result.status == "complete" and not result.warnings
    assert result["body/position"].shape == (26, 4, 3)
    np.testing.assert_allclose(result["point.1.z"], 2 * np.cos(3.0 * result.time), rtol=0, atol=1e-12)
    assert (result.unit("point.1.z"), result.unit("body/velocity"), result.unit("time")) == ("m", "m/s", "s")


@pytest.mark.parametrize(
    "deck", ["young/IN4-BAR.dat", pytest.param("dafms/pendulum.DAT", marks=pytest.mark.long_motion)]
)
def test_a_saved_result_is_the_file_of_the_command(deck, tmp_path):
    solve(DECKS / deck).save(tmp_path / "saved.h5")
    CliRunner().invoke(run, [str(DECKS / deck), "-q", "--h5", str(tmp_path / "run.h5"), "--no-out"])
    assert (tmp_path / "saved.h5").read_bytes() == (tmp_path / "run.h5").read_bytes()


@pytest.mark.parametrize(
    ("text", "changes", "message"),
    [
        (None, {}, "deck.dat: no such file"),
        ("1 0 0 0 0 0 0 0 0 0 0 0\n0 0 O 1 0 0 0\n0 1 0.5\n", {}, "deck.dat:2:5: body 1: z must be a number"),
        ("1 0 0 0 0 0 0 0 0 0 0 0\n0 0 0 1 0 0 0\n0 1 0.5\n", {"body.1.q": 1}, "deck.dat: "),
    ],
)
def test_a_failure_names_the_deck_and_the_place_in_it(tmp_path, text, changes, message):
    path = tmp_path / "deck.dat"
    if text:
        path.write_text(text)
    with pytest.raises(FlexmbError) as caught:
        read_deck(path, changes)
    assert str(caught.value).startswith(f"{tmp_path}/{message}")


@pytest.mark.parametrize(
    ("option", "kind", "message"),
    [
        ({"rtol": 5}, ValueError, "solve needs 1e-14 <= rtol < 1; read 5"),
        ({"atol": float("nan")}, ValueError, "solve needs 0 < atol < 1; read nan"),
        ({"most_iterations": "many"}, ValueError, "solve needs 1 <= most_iterations, finite; read 'many'"),
        ({"formulation": "newton"}, ValueError, "formulation is one of kane, absolute; read 'newton'"),
        ({"method": "rk45"}, ValueError, "method is one of dop853, radau, alpha, lsoda, sdirk4; read"),
        ({"rtoll": 1}, TypeError, "solve has no option 'rtoll'; is rtol meant?"),
        ({"folder": "x"}, TypeError, "solve has no option 'folder'; it has rtol, "),
    ],
)
def test_solve_refuses_what_the_command_refuses(option, kind, message):
    with pytest.raises(kind) as caught:
        solve(FOUR_BAR, **option)
    assert str(caught.value).startswith(message)


def test_a_failed_run_names_its_deck_and_a_key_no_option_of_the_command():
    with pytest.raises(AnalysisError, match=r"IN4-BAR\.dat:\d+:\d+: ") as caught:
        solve(read_deck(FOUR_BAR, changes={"revolute.2.P_i.y": 4.0}))
    assert caught.value.result.message == caught.value.faults[0].sentence
    with pytest.raises(KeyError) as unknown:
        caught.value.result["qqq"]
    assert "--list" not in str(unknown.value)


def test_an_unknown_name_is_answered_with_near_ones():
    with pytest.raises(KeyError, match=r"near it are point\.1"):
        solve(FOUR_BAR)["point.1.w"]


def test_several_numbers_need_a_table():
    result = solve(FOUR_BAR)
    with pytest.raises(KeyError, match="more than one number"):
        result["point.1"]
    pandas = pytest.importorskip("pandas")
    table = result.to_pandas("point.1.z", "body.2.x")
    assert isinstance(table, pandas.DataFrame)
    np.testing.assert_array_equal(table["point.1.z"], result["point/position"][:, 0, 2])
    assert table.index.name == "time"
    assert table.attrs["units"] == {"point.1.z": "m", "body.2.x": "m"}


def test_a_table_has_the_numbers_of_a_dataset_or_all():
    """Four bodies of seven coordinates, two derivatives, two angular vectors; point, two angles, audits."""
    pytest.importorskip("pandas")
    result = solve(FOUR_BAR)
    table = result.to_pandas("body/velocity")
    assert list(table.columns)[:2] == ["body.1.velocity.x", "body.1.velocity.y"]
    np.testing.assert_array_equal(table.to_numpy(), result["body/velocity"].reshape(26, 12))
    assert result.to_pandas().shape == (26, 4 * (3 * 7 + 2 * 3) + 3 * 3 + 2 * 2 + 3)


def test_a_result_is_a_mapping():
    result = solve(FOUR_BAR)
    assert len(list(result.values())) == len(result) == len(list(result.items()))
    assert {id(values) for values in result.values()} == {id(result[path]) for path in result}


def test_a_result_has_the_datasets_of_its_file_with_their_units(tmp_path):
    """Units of the file itself; the pendulum has no pins, whose forces would be an array without a column."""
    result = solve(read_deck(DECKS / "vsdf/pendulum.vsdf", changes={"time.end": 0.001}))
    result.save(tmp_path / "saved.h5")
    with h5py.File(tmp_path / "saved.h5") as file:
        assert {path: result.unit(path) for path in result} == {
            path: file[path].attrs["units"] for path in result
        }
        assert "held" not in file
    assert "held/force" not in result


def test_a_result_without_rows_says_so():
    """A crank of 400 m cannot be closed: the run fails before its first row."""
    with pytest.raises(AnalysisError) as caught:
        solve(read_deck(FOUR_BAR, changes={"revolute.2.P_i.y": 400.0}))
    result = caught.value.result
    assert len(result) == len(result.time) == len(result["point.1.z"]) == 0
    pytest.importorskip("pandas")
    assert result.to_pandas("body").shape == (0, 4 * 27)


def test_xarray_sees_groups_with_units():
    pytest.importorskip("h5netcdf")
    tree = solve(FOUR_BAR).to_xarray()
    assert tree["body"]["position"].attrs["units"] == "m"
    assert tree["body"]["position"].shape == (26, 4, 3)


def test_documented_exceptions_are_those_that_are_raised(tmp_path):
    assert issubclass(ModelError, DeckError) and issubclass(AnalysisError, FlexmbError)
    (tmp_path / "empty.dat").write_text("")
    with pytest.raises(DeckError):
        read_deck(tmp_path / "empty.dat")


@pytest.mark.parametrize(
    ("module", "installed", "call"),
    [
        ("pandas", "pandas", lambda result: result.to_pandas("time")),
        ("xarray", "xarray h5netcdf", lambda result: result.to_xarray()),
    ],
)
def test_a_library_that_is_missing_is_named_with_its_installation(module, installed, call, monkeypatch):
    result = solve(FOUR_BAR)
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(FlexmbError, match=rf"to_{module} needs {module}.*; install it with: .*{installed}$"):
        call(result)


def test_rows_before_a_lock_are_kept(tmp_path):
    """A crank of 1 m and a rod of 3 m reach 4 m; at 0.5 s the slider is asked for 4.02 m."""
    text = slider_crank(1, 3, (3.42, 1.6, -1.6), (0, 2, 0.25), 1.0)
    (tmp_path / "locked.dat").write_text(text)
    with pytest.raises(AnalysisError) as raised:
        solve(tmp_path / "locked.dat")
    assert raised.value.result.status == "failed"
    assert raised.value.result.message
    assert raised.value.result.time.tolist() == [0.0, 0.25]


def test_faults_of_a_deck_have_place_and_identifier():
    with pytest.raises(FlexmbError) as raised:
        read_deck(FOUR_BAR, changes={"driver.9.B": 1.0})
    assert raised.value.faults[0].id and "driver" in raised.value.faults[0].message


def test_a_failure_says_which_deck_and_where(tmp_path):
    with pytest.raises(FlexmbError, match=r"^none\.dat: no such file$"):
        read_deck("none.dat")
    wrong = tmp_path / "wrong.dat"
    wrong.write_text(FOUR_BAR.read_text().replace("1 2 0 0 2 0 6.10", "1 9 0 0 2 0 6.10"))
    with pytest.raises(FlexmbError) as caught:
        solve(wrong)
    assert str(caught.value) == f"{wrong}:14:3: universal joint 1: body number 9 is outside 1..4"


@pytest.mark.parametrize(
    ("function", "arguments"),
    [
        ("solve_to_files", ["run", FOUR_BAR, "-q"]),
        ("check", ["check", FOUR_BAR, "-q"]),
        ("open_study", ["sweep", DECKS / "studies/rssr.toml", "-q"]),
        ("solve_study", ["sweep", DECKS / "studies/rssr.toml", "-q"]),
        ("write_study", ["sweep", DECKS / "studies/rssr.toml", "-q"]),
    ],
)
def test_commands_call_the_interface(function, arguments, tmp_path, monkeypatch):
    """What stands in the place of a function of the interface answers for the command."""

    class Reached(BaseException):
        pass

    def reached(*_, **__):
        raise Reached

    monkeypatch.chdir(tmp_path)
    if function == "write_study":
        monkeypatch.setattr(interface, "solve_study", lambda *_, **__: None)
    monkeypatch.setattr(interface, function, reached)
    with pytest.raises(Reached):
        cli.main([str(word) for word in arguments], standalone_mode=False)


def test_check_takes_the_options_of_the_command():
    found = check(read_deck(FOUR_BAR, changes={"driver.1.B": 3.0}), RunOptions(strict=True), "estimate")
    assert found.jacobian.matrix.shape == (28, 28)
    assert found.deck.options == () and found.outcome.settings == ("driver.1.B=3.0",)


def test_check_takes_the_deck_that_was_read(tmp_path):
    """Its comment begins like a VSDF deck: the dialect was given, and the file is gone since."""
    path = tmp_path / "crank.dat"
    path.write_text("{ VSDF\n}\n" + FOUR_BAR.read_text())
    opened = read_deck(path, changes={"driver.1.B": 3.0}, dialect="young")
    path.unlink()
    found = check(opened)
    assert (found.rank, found.outcome.exit_code, found.deck.dialect) == (28, 0, "young")
    assert found.outcome.settings == ("driver.1.B=3.0",)


def test_a_report_of_check_is_shown_in_one_line():
    found = check(FOUR_BAR)
    assert repr(found) == f"CheckReport({str(FOUR_BAR)!r}, complete, 0 errors, 0 warnings, 0 notes)"
    assert isinstance(found, flexmb_cli.CheckReport)
    assert flexmb_cli.RunOptions is RunOptions


def test_a_report_of_check_has_the_faults():
    (fault,) = check("none.dat").faults
    assert (fault.severity, fault.id) == ("error", "DECK-011")


def test_check_reports_mobility():
    report = check(FOUR_BAR)
    assert (report.rank, report.free, report.outcome.exit_code) == (28, [], 0)


def test_a_study_leaves_the_garbage_collector_as_it_was(tmp_path):
    """Cases freeze what is there before them, until they are solved."""
    text = f'deck = "{FOUR_BAR}"\n[parameters]\n"driver.1.B" = [3.0]\n[results]\nlow = "min point.1.z"\n'
    (tmp_path / "study.toml").write_text(text)
    gc.unfreeze()
    sweep(tmp_path / "study.toml")
    assert (gc.get_freeze_count(), gc.isenabled()) == (0, True)


def test_a_study_gives_columns():
    """Of the supplied study: five speeds by two points of the coupler, ten cases that all run.

    The end of the coupler goes around with the crank of 0.1 m; its other end swings in the plane x = 0: the
    middle is half as fast along x.  The first row has the largest speed, when the crank stands up.
    """
    table = sweep(DECKS / "studies/rssr.toml")
    assert table["parameter/driver.1.B"].shape == (10,)
    share = 1 - table["parameter/point.1.y"] / 0.4812
    assert set(share) == {1.0, 0.5}
    fastest = table["parameter/driver.1.B"] * 0.1 * share
    np.testing.assert_allclose(table["result/fastest"], fastest, rtol=1e-9)
    assert table["result/lowest"].std() > 0.01
    assert table["result/path"].shape[0] == 10


def test_a_deck_may_be_given_as_text():
    text = FOUR_BAR.read_text()
    result, expected = solve(read_deck(text, changes={"driver.1.B": 3.0})), solve(FOUR_BAR)
    assert np.array_equal(solve(read_deck(text))["body/position"], expected["body/position"])
    assert not np.array_equal(result["body/velocity"], expected["body/velocity"])
    with pytest.raises(DeckError, match=r"^deck:14:3: universal joint 1: body number 9"):
        solve(read_deck(text.replace("\n1 2 0 0 2 0 6.10", "\n1 9 0 0 2 0 6.10")))


def test_a_study_in_a_dict_is_that_of_the_file(monkeypatch):
    """The content of decks/studies/rssr.toml; the deck is relative to the working folder."""
    monkeypatch.chdir(DECKS)
    study = {
        "deck": Path("young/IN-RSSR.dat"),
        "parameters": {"driver.1.B": np.linspace(100.0, 200.0, 5), "point.1.y": (0.0, 0.2406)},
        "results": {
            "lowest": "min point.1.z",
            "fastest": "max point.1.velocity.x",
            "path": "series point.1.z",
        },
    }
    from_dict, from_file = sweep(study), sweep("studies/rssr.toml")
    assert from_dict.keys() == from_file.keys()
    assert all(np.array_equal(from_dict[name], from_file[name]) for name in from_file)
    study["parameters"]["driver.1.BB"] = [1.0]
    with pytest.raises(FlexmbError, match=r"driver\.1\.BB"):
        sweep(study)


@pytest.mark.processes
def test_importing_the_package_loads_no_numerical_library():
    code = "import sys, flexmb_cli; print(sorted({'numpy', 'h5py', 'click', 'numba'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_names_are_completed_before_they_are_used():
    code = "import sys, flexmb_cli as f; print(set(f.__all__) - set(dir(f)), 'numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set() False"


def test_the_package_is_marked_as_typed():
    assert (Path(flexmb_cli.__file__).parent / "py.typed").is_file()
    with pytest.raises(AttributeError, match="no attribute 'solv'"):
        _ = flexmb_cli.solv


@pytest.mark.long_motion
@pytest.mark.parametrize("deck", ["young/IN4-BAR.dat", "dafms/pendulum.DAT", "vsdf/pendulum.vsdf"])
def test_a_stored_result_has_the_names_units_and_values_of_one_in_memory(deck, tmp_path):
    solved = solve(DECKS / deck)
    solved.save(path := tmp_path / "result.h5")
    stored = Result.open(path)
    assert set(stored) == set(solved) and stored.status == "complete"
    assert all(np.array_equal(stored[name], solved[name], equal_nan=True) for name in solved)
    assert all(stored.unit(name) == solved.unit(name) for name in solved)
    columns = stored.to_pandas().columns
    assert list(columns) == list(solved.to_pandas().columns)
    assert stored.unit(columns[3]) == solved.unit(columns[3])
    assert np.array_equal(stored[columns[3]], solved[columns[3]])
    assert stored.deck.numbers == solved.deck.numbers
    stored.save(copy := tmp_path / "copy.h5")
    assert copy.read_bytes() == path.read_bytes()
    with pytest.raises(KeyError, match=r"point\.1\.zz|no such quantity"):
        stored["point.1.zz"]


def test_what_is_no_result_is_refused_by_open(tmp_path):
    (tmp_path / "a.h5").write_text("text")
    with pytest.raises(FlexmbError, match="not an HDF5 result"):
        Result.open(tmp_path / "a.h5")


def test_notebooks_show_extremes_curves_and_the_page():
    result = solve(DECKS / "young/IN4-BAR.dat")
    shown = result._repr_html_()
    least = f"{result['point.1.z'].min():.6g}"
    assert "point.1.z" in shown and f"<td>{least}</td>" in shown and "complete, 26 rows" in shown
    figure = result.plot("point.1.z", "point.1.y")
    (axes,) = figure.axes
    assert np.array_equal(axes.lines[0].get_ydata(), result["point.1.z"])
    (axes,) = result.plot("point.1.z", units="mm").axes
    assert "[mm]" in axes.get_ylabel()
    np.testing.assert_allclose(axes.lines[0].get_ydata(), 1000 * result["point.1.z"], rtol=1e-14)
    with pytest.raises(ValueError, match="furlong"):
        result.plot("point.1.z", units="furlong")
    with pytest.raises(FlexmbError, match=r"point\.9\.q"):
        result.plot("point.9.q")
    page = result.show(height=500)
    assert page.html.startswith("<!DOCTYPE html>") and "kB" in repr(page)
    (source,) = re.fullmatch(
        r'<iframe srcdoc="([^"]*)" [^<>]*height="500"[^<>]*></iframe>', page._repr_html_()
    ).groups()
    assert html.unescape(source) == page.html
