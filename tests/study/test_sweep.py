"""Studies: every case as its own run gives it, failures recorded, and nothing lost when they are stopped."""

import json
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from flexmb_cli import interface
from flexmb_cli.errors import ModelError
from flexmb_cli.interface import sweep
from flexmb_cli.kernels import _jit
from flexmb_cli.run.outcome import Listener
from flexmb_cli.solvers import compilation
from flexmb_cli.study import workers as study_workers
from flexmb_cli.study.solver import CaseSolver
from flexmb_cli.study.study import Cases
from flexmb_cli.study.sweep import Sweep
from tests.study.studies import OWN_MODELS, RSSR, SAMPLED, SMALL, flexmb, written

pytestmark = pytest.mark.processes

study_workers_serve = study_workers._serve
DECKS = Path(__file__).resolve().parents[2] / "decks"
PENDULUM = DECKS / "dafms/pendulum.DAT"


def table(path):
    with h5py.File(path) as file:
        columns = [f"{group}/{name}" for group in ("parameter", "result") for name in file[group]]
        found = {name: file[name][:] for name in ("case", "exit_code", "rows", *columns)}
        return found | {"message": file["message"].asstr()[:].tolist()}


def test_every_case_is_what_run_gives_with_set(tmp_path):
    flexmb("sweep", written(tmp_path, SMALL), "-j", 2, "-q", cwd=tmp_path)
    found = table(tmp_path / "study.h5")
    assert found["case"].tolist() == [1, 2, 3, 4, 5, 6] and not found["exit_code"].any()
    for k, (speed, x) in enumerate((b, x) for b in (100.0, 146.6, 150) for x in (0.0, 0.05)):
        assert (found["parameter/driver.1.B"][k], found["parameter/point.1.x"][k]) == (speed, x)
        settings = ["--set", f"driver.1.B={speed}", "--set", f"point.1.x={x}"]
        flexmb("run", RSSR, *settings, "-q", "--no-out", "--h5", f"{k}.h5", cwd=tmp_path)
        with h5py.File(tmp_path / f"{k}.h5") as one:
            point, omega = one["point/position"][:, 0], one["body/angular_velocity"][:, 1, 0]
        assert found["result/top"][k] == point[:, 2].max()
        assert found["result/last"][k] == omega[-1]
        np.testing.assert_array_equal(found["result/path"][k], point[:, 1])
    assert not (tmp_path / "study.h5.parts").exists()


@pytest.mark.parametrize(
    "fault, code, message",
    [
        (MemoryError(), 1, "not enough memory (`ulimit -v` shows a limit); `sweep --fresh` solves"),
        (ZeroDivisionError("/home/me/x.py"), 3, "a fault of flexmb itself: ZeroDivisionError; `flexmb"),
        (RuntimeError("singular"), 3, "a fault of flexmb itself: RuntimeError; `flexmb"),
    ],
)
def test_what_ends_one_case_is_recorded_and_the_next_is_solved(tmp_path, monkeypatch, fault, code, message):
    sweep = Sweep.of(str(written(tmp_path, OWN_MODELS, count=3)), str(tmp_path / "parts"))
    whole, struck = CaseSolver._solution, []

    def fails(solver, deck):
        if deck is not solver.deck and not struck:
            struck.append(deck)
            raise fault
        return whole(solver, deck)

    monkeypatch.setattr(CaseSolver, "_solution", fails)
    study_workers.solve_here(sweep, sweep.pending(), lambda cases: None)
    first, *others = sweep.results()
    assert first.exit_code == code and first.message.startswith(message)
    assert [other.exit_code for other in others] == [0, 0]


def test_a_latin_hypercube_has_one_case_in_every_stratum(tmp_path):
    sweep = Sweep.of(str(written(tmp_path, SAMPLED, count=50)), str(tmp_path / "parts"))
    rows = np.array([Cases(sweep.job.study).row(case) for case in range(50)])
    linear = (rows[:, 0] - 100.0) / 100.0
    logarithmic = np.log(rows[:, 1] / 0.001) / np.log(1000.0)
    for column in (linear, logarithmic):
        assert sorted(np.floor(50 * column).astype(int)) == list(range(50))


def test_a_case_that_fails_is_recorded_and_stops_nothing(tmp_path):
    text = SMALL.replace('"point.1.x" = [0.0, 0.05]', '"spherical.1.P_j.z" = [0.0, 400.0]')
    done = flexmb("sweep", written(tmp_path, text), "--json", cwd=tmp_path, check=False)
    assert done.returncode == 1
    reported = json.loads(done.stdout)
    assert (reported["status"], reported["exit_code"], reported["cases"], reported["failed"]) == (
        "failed",
        1,
        6,
        3,
    )
    assert [fault["id"] for fault in reported["faults"]] == 3 * ["STUDY-031"]
    assert "case 2: " in reported["faults"][0]["message"] and "case 2: " in done.stderr
    found = table(tmp_path / "study.h5")
    failed = found["exit_code"] == 1
    assert failed.tolist() == (found["parameter/spherical.1.P_j.z"] == 400.0).tolist()
    assert "cannot be assembled" in found["message"][1]
    assert np.isnan(found["result/top"][failed]).all() and np.isnan(found["result/path"][failed]).all()


LOCKS = """
deck = "{deck}"
[parameters]
"revolute.2.P_i.y" = [3.7, 4.0]
[results]
top = "max body.3.z"
start = "first body.3.z"
path = "series body.3.z"
"""


def test_a_case_that_locks_has_no_results_but_the_rows_before(tmp_path):
    """The coupler of 4.0 m locks at 1.19 s, in the 12th step of 0.1 s: the largest of 12 rows is no peak."""
    (tmp_path / "study.toml").write_text(LOCKS.format(deck=RSSR.with_name("IN4-BAR.dat")))
    found = sweep(tmp_path / "study.toml")
    assert found["exit_code"].tolist() == [0, 1] and found["rows"].tolist() == [26, 12]
    for name in ("result/top", "result/start"):
        assert np.isnan(found[name]).tolist() == [False, True]
    assert np.isfinite(found["result/path"][1]).sum() == 12
    np.testing.assert_allclose(found["result/time"][0], np.arange(26) * 0.1, rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    "change, message",
    [
        (('"point.1.x"', '"point.9.x"'), "the deck has no number 'point.9.x'; near it are point."),
        (("max point.1.z", "max point.1.q"), "point.1.q: the result has no such quantity"),
        (("max point.1.z", "max point.1"), "result top: point.1 is more than one number"),
        (("IN-RSSR.dat", "none.dat"), "none.dat: error: no such file"),
        (("IN-RSSR.dat", "../../LICENSE"), "LICENSE:1:1: error: no dialect begins like this"),
    ],
)
def test_what_a_deck_does_not_have_is_refused_before_anything_is_solved(tmp_path, change, message):
    study = written(tmp_path, SMALL)
    study.write_text(study.read_text().replace(*change))
    done = flexmb("sweep", study, cwd=tmp_path, check=False)
    assert done.returncode == 2 and message in done.stderr, done.stderr
    assert not list(tmp_path.glob("*.parts"))


def test_a_tree_is_swept_too(tmp_path):
    """Elastic pendulum: IT steps make IT + 1 rows, the last at IT x H = 0.1 and 0.2 s."""
    text = f'deck = "{PENDULUM}"\n[parameters]\n"time.IT" = [10, 20]\n[results]\nlast = "last time"\n'
    (tmp_path / "study.toml").write_text(text)
    flexmb("sweep", "study.toml", "-q", cwd=tmp_path)
    found = table(tmp_path / "study.h5")
    assert found["rows"].tolist() == [11, 21]
    assert found["result/last"].tolist() == pytest.approx([0.1, 0.2], rel=1e-15)


def test_a_flexible_body_is_swept_with_its_files(tmp_path):
    """A case is what `flexmb run --set` gives of the same number."""
    deck = DECKS / "vsdf/pendulum.vsdf"
    text = f'deck = "{deck}"\n[parameters]\n"gravity.g.z" = [-9.81, -19.62]\n[results]\nz = "min point.1.z"\n'
    (tmp_path / "study.toml").write_text(text)
    flexmb("sweep", "study.toml", "-q", cwd=tmp_path)
    found = table(tmp_path / "study.h5")
    flexmb("run", deck, "--set", "gravity.g.z=-19.62", "-q", "--no-out", "--h5", "one.h5", cwd=tmp_path)
    with h5py.File(tmp_path / "one.h5") as one:
        assert found["result/z"][1] == one["point/position"][:, 0, 2].min() != found["result/z"][0]


def test_another_study_in_the_same_folder_is_refused(tmp_path):
    study, parts = written(tmp_path, SAMPLED, count=5), str(tmp_path / "parts")
    Sweep.of(str(study), parts)
    study.write_text(study.read_text().replace("200.0", "201.0"))
    with pytest.raises(ModelError, match="holds a stopped study that differs in study; --fresh"):
        Sweep.of(str(study), parts)
    assert not Sweep.of(str(study), parts, fresh=True).restored


def test_a_folder_that_is_no_study_is_left_alone(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts/thesis.txt").write_text("dear to me")
    with pytest.raises(ModelError, match="is not empty and holds no study"):
        Sweep.of(str(written(tmp_path, SAMPLED, count=5)), str(tmp_path / "parts"), fresh=True)
    assert (tmp_path / "parts/thesis.txt").exists()


def test_parquet_holds_the_same_numbers(tmp_path):
    import pyarrow.parquet

    study = written(tmp_path, SMALL)
    flexmb("sweep", study, "-q", cwd=tmp_path)
    flexmb("sweep", study, "-q", "-o", "study.parquet", cwd=tmp_path)
    hdf5 = table(tmp_path / "study.h5")
    columns = pyarrow.parquet.read_table(tmp_path / "study.parquet").to_pydict()
    for name, values in hdf5.items():
        np.testing.assert_array_equal(values, columns[name.replace("/", ".", 1)])


def test_a_script_without_a_test_of_its_name_sweeps_in_processes(tmp_path):
    """Each process ran the script anew, which raised RuntimeError there and ended it: three tracebacks."""
    study = written(tmp_path, SMALL)
    (tmp_path / "mine.py").write_text(
        f"from flexmb_cli import sweep\nprint(sweep({str(study)!r}, jobs=2)['exit_code'])\n"
    )
    done = subprocess.run([sys.executable, "mine.py"], cwd=tmp_path, capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("[0 0 0 0 0 0]\n", "")


def needs_to_compile(entry):
    return True


def serves_with_new_kernels(line, job):
    """In place of `_serve`: a process whose kernels have yet to be compiled."""
    _jit.must_compile = needs_to_compile
    compilation._reported.clear()
    study_workers_serve(line, job)


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_study_reports_once_that_kernels_are_compiled(tmp_path, monkeypatch, jobs):
    """`sweep -v` was silent for the 20 s that this takes."""
    monkeypatch.setattr(_jit, "must_compile", needs_to_compile)
    monkeypatch.setattr(compilation, "_reported", set())
    monkeypatch.setattr(study_workers, "_serve", serves_with_new_kernels)
    sweep, said = Sweep.of(str(written(tmp_path, SMALL)), str(tmp_path / "parts")), []
    interface.solve_study(sweep, sweep.pending(), jobs=jobs, listener=Listener(status=said.append))
    assert said == [compilation.COMPILING]


def test_json_has_the_warnings_that_are_printed(tmp_path):
    """Rule: every warning on standard error stands with its identifier in `--json`; the list was empty."""
    study = written(tmp_path, SMALL)
    flexmb("run", DECKS / "young/IN4-BAR.dat", "-q", "--h5", "study.h5", "--no-out", cwd=tmp_path)
    done = flexmb("sweep", study, "--json", cwd=tmp_path)
    (warning,) = json.loads(done.stdout)["faults"]
    assert (warning["id"], warning["severity"]) == ("STUDY-029", "warning")
    assert f"warning: {warning['message']}" in done.stderr
