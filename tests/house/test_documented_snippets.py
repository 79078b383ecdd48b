"""Programs on the pages that are no transcripts: each runs literally and finds what other code finds."""

import json
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import h5py
import numpy as np
import pytest

from flexmb_cli.run.convert import converted

pytestmark = pytest.mark.processes

TOP = Path(__file__).resolve().parents[2]
DOCS = TOP / "docs"
TURNTABLE = TOP / "tests/solvers/linearisation/turning/turntable.dat"


def snippets(page, language="python"):
    return re.findall(rf"```{language}\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)


def flexmb(folder, *arguments):
    subprocess.run([sys.executable, "-m", "flexmb_cli", *arguments], cwd=folder, check=True, timeout=600)


@pytest.fixture
def commands(tmp_path, monkeypatch):
    """A folder with IN4-BAR.dat, its result, and `flexmb` and `python` on the path."""
    places = tmp_path / "bin"
    places.mkdir()
    for name, arguments in (("flexmb", "-m flexmb_cli "), ("python", "")):
        (places / name).write_text(f'#!/bin/sh\nexec "{sys.executable}" {arguments}"$@"\n')
        (places / name).chmod(0o755)
    monkeypatch.setenv("PATH", str(places), prepend=":")
    shutil.copy(TOP / "decks/young/IN4-BAR.dat", tmp_path)
    flexmb(tmp_path, "run", "IN4-BAR.dat", "-q")
    return tmp_path


def printed(folder, program):
    """What a program of a page prints, in the folder of its files."""
    command = ["sh", "-e", "-c", program] if program.startswith("flexmb") else [sys.executable, "-c", program]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True, timeout=300)
    return done.stdout


def test_xarray_opens_the_result_as_the_page_shows(commands):
    pytest.importorskip("h5netcdf")
    (_, program) = snippets("how-to/python.md")
    assert printed(commands, program) == "(4, 3)\n"  # bodies of the deck, axes


def test_pandas_reads_the_table_from_a_pipe_as_the_page_shows(commands):
    pytest.importorskip("pandas")
    (program,) = snippets("how-to/python.md", "sh")
    shown = printed(commands, program)
    with h5py.File(commands / "OUT4-BAR.h5") as result:
        rows = len(result["time"])
    assert re.search(rf"^count\s+{rows}\.0", shown, re.MULTILINE) and "time" in shown


def test_errors_are_caught_as_the_page_of_the_interface_shows(commands):
    """The rows are those of the report times before the stop, 0.1 s apart."""
    (_, program, *_) = snippets("reference/python.md")
    shown = re.fullmatch(r"stopped at (\S+) s: failed, (\d+) rows\n", printed(commands, program))
    assert 0 < float(shown[1]) < 2.5 and int(shown[2]) == round(float(shown[1]) / 0.1)


def test_results_are_opened_and_studies_begun_as_the_page_of_the_interface_shows(commands):
    (_, _, program, _) = snippets("reference/python.md")
    assert f"```text\n{printed(commands, program)}```" in (TOP / "docs/reference/python.md").read_text()


def test_the_program_of_the_readme_runs_and_draws(tmp_path):
    """README.md: the lowest place of the point does not depend on the speed of its crank."""
    (tmp_path / "decks").symlink_to(TOP / "decks")
    (program,) = snippets("../README.md")
    shown = printed(tmp_path, program + "print(table['result/z'])")
    status, lowest, table = re.fullmatch(r"(\w+) \(26, 4, 3\) (\S+)\n\[(.*)\]\n", shown).groups()
    assert status == "complete" and float(lowest) == pytest.approx(-1.98, abs=0.03)
    assert [float(each) for each in table.split()] == pytest.approx([-1.98, -1.98], abs=0.03)
    assert (tmp_path / "path.png").read_bytes().startswith(b"\x89PNG")


def test_the_record_of_json_is_read_as_the_page_shows(commands):
    (*_, program) = snippets("reference/python.md")
    assert printed(commands, program) == "complete 26 ['OUT4-BAR.dat', 'OUT4-BAR.h5']\n"


def test_a_state_space_is_read_as_the_page_of_modes_shows(tmp_path):
    """Square A; one column of B and D for the driver, and as many states as B and C have."""
    shutil.copy(TURNTABLE, tmp_path / "turntable.dat")
    flexmb(tmp_path, "modes", "turntable.dat", "--out", "turntable.npz", "-q")
    (program,) = snippets("reference/modes.md")
    shown = printed(
        tmp_path, program + "print(system.A.shape, system.B.shape, system.C.shape, system.D.shape)"
    )
    states, inputs, outputs, through = re.findall(r"\((\d+), (\d+)\)", shown)
    assert states[0] == states[1] == inputs[0] == outputs[1] and inputs[1] == through[1] == "1"
    assert outputs[0] == through[0]


def test_a_study_becomes_a_grid_in_xarray_as_the_page_shows(tmp_path):
    pytest.importorskip("h5netcdf")
    flexmb(tmp_path, "sweep", str(TOP / "decks/studies/rssr.toml"), "-q", "-o", "study.h5")
    (program,) = snippets("reference/studies.md")
    program += "import json; print(json.dumps([grid.fastest.dims, grid.fastest.values.tolist()]))"
    shown = json.loads(printed(tmp_path, program))
    assert shown[0] == ["driver.1.B", "point.1.y"]
    # The crank of 0.1 m carries the first point: its speed is 0.1 m times that of the driver.
    np.testing.assert_allclose(np.array(shown[1])[:, 0], 0.1 * np.linspace(100, 200, 5), rtol=1e-9)


def test_the_script_for_exudyn_is_compared_as_the_page_shows(commands):
    """The first tenth of the deck's motion; `test_decks_in_exudyn.py` runs it to its end."""
    deck = "decks/young/dynamics/IN-BRICARD.dat"
    (commands / deck).parent.mkdir(parents=True)
    (commands / deck).write_text((TOP / deck).read_text().replace("0 5 0.05", "0 0.5 0.05"))
    (commands / "bricard.py").write_text(converted(str(commands / deck), "exudyn"))
    (program,) = snippets("how-to/convert.md", "sh")
    assert "no difference in" in printed(commands, program)


def test_the_frequency_of_a_pendulum_is_differentiated_as_the_page_shows():
    """The elastic pendulum: d ln f1/d ln g = (1 - x/(l + x))/2 = 0.375, x = 0.1 m, l = 0.3 m."""
    (program,) = snippets("how-to/sensitivities.md")
    assert printed(TOP, program) == "(1, 1, 1) [0.375]\n"


def test_studies_of_the_lesson_on_fits_are_those_supplied():
    """The first is whole but for comments, the second the targets alone."""
    whole, targets = map(tomllib.loads, snippets("tutorial/fit.md", "toml"))
    spring, path = (
        tomllib.loads((TOP / f"decks/studies/{name}.toml").read_text()) for name in ("spring", "path")
    )
    assert whole == spring and targets["targets"] == path["targets"]
