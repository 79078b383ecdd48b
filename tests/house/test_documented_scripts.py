"""Programs of the pages that need a cluster, ParaView or CI; and a list of all programs with their tests."""

import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import tomllib
from pathlib import Path

import h5py
import pytest

from tests.house.test_documentation import PAGES, named

pytestmark = pytest.mark.processes

TOP = Path(__file__).resolve().parents[2]
DOCS = TOP / "docs"
# Files of tests that run the programs of a page, in the order of the page; what begins with "not run" is not.
INSTALLS = (
    "not run: installs from the network; scripts/prove_wheel and scripts/venv install by the same commands"
)
HERE, SNIPPETS = "test_documented_scripts.py", "test_documented_snippets.py"
TRANSCRIPTS = "test_documentation.py"
RUN_BY = {
    "README.md": [INSTALLS, INSTALLS, SNIPPETS],
    "docs/index.md": [INSTALLS],
    "CONTRIBUTING.md": ["not run: makes an environment and runs this whole suite, as CI does (.ci/run)"],
    "docs/how-to/ci-files.md": ["../scripts/test_ci_files.py", "../scripts/test_ci_files.py"],
    "docs/how-to/clusters.md": [HERE, "not run: `head` is a machine; the next program does the same", HERE],
    "docs/how-to/compare-in-ci.md": [HERE],
    "docs/how-to/convert.md": [SNIPPETS, TRANSCRIPTS],
    "docs/how-to/paraview.md": [
        "not run: ParaView is no test dependency; the file has the names used (here)"
    ],
    "docs/how-to/python.md": [TRANSCRIPTS, SNIPPETS, SNIPPETS],
    "docs/how-to/sensitivities.md": [SNIPPETS],
    "docs/reference/modes.md": [SNIPPETS],
    "docs/reference/python.md": [TRANSCRIPTS, SNIPPETS, SNIPPETS, SNIPPETS],
    "docs/reference/studies.md": [SNIPPETS],
    "docs/tutorial/fit.md": [SNIPPETS, SNIPPETS],
    "docs/tutorial/installation.md": [INSTALLS, INSTALLS, INSTALLS],
}


def programs(page, languages=("sh", "python", "yaml", "toml")):
    """Programs and files of a page that are no transcripts."""
    blocks = re.findall(r"^```(\w+)\n(.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    return [block for language, block in blocks if language in languages]


def test_every_program_of_a_page_has_its_test_or_a_reason():
    counted = {named(page): len(programs(page)) for page in PAGES if programs(page)}
    assert counted == {page: len(tests) for page, tests in RUN_BY.items()}
    for page, tests in RUN_BY.items():
        for test in tests:
            source = Path(__file__).parent / test
            assert test.startswith("not run: ") or Path(page).name in source.read_text(), (page, test)


@pytest.fixture
def shared(tmp_path):
    """A folder as /shared of the page: a study, an environment, and Slurm's `srun` of two tasks."""
    places = tmp_path / "flexmb/.venv/bin"
    places.mkdir(parents=True)
    for name, arguments in (("flexmb", "-m flexmb_cli "), ("python", ""), ("dask", "-m dask ")):
        (places / name).write_text(f'#!/bin/sh\nexec "{sys.executable}" {arguments}"$@"\n')
    (places / "srun").write_text('#!/bin/sh\n"$@" &\n"$@" &\nwait\n')
    for path in places.iterdir():
        path.chmod(0o755)
    (places / "activate").write_text(f'PATH="{places}:$PATH"\n')
    (tmp_path / "study").mkdir()
    shutil.copy(TOP / "decks/young/IN-RSSR.dat", tmp_path / "study")
    text = (TOP / "decks/studies/rssr.toml").read_text().replace("../young/", "")
    (tmp_path / "study/study.toml").write_text(text)
    return tmp_path


def in_shell(script, folder):
    """Return exit code and output of a job; what it leaves after is ended, as Slurm does."""
    said = folder / "job.log"
    with open(said, "wb") as log:
        job = subprocess.Popen(
            ["sh", "-c", script], cwd=folder, stdout=log, stderr=log, start_new_session=True
        )
        try:
            code = job.wait(timeout=600)
        finally:
            # Workers that never met the scheduler would look for it without end.
            with contextlib.suppress(ProcessLookupError):
                os.killpg(job.pid, signal.SIGKILL)
    return code, said.read_text(encoding="utf-8", errors="replace")


def fastest(study):
    with h5py.File(study) as table:
        return table["result/fastest"][:].tolist()


def test_the_job_of_slurm_solves_the_study_as_one_machine_does(shared):
    """All lines are run; `compile` finds the kernels of this machine, which else take minutes."""
    pytest.importorskip("distributed")
    alone, _, job = programs(DOCS / "how-to/clusters.md")
    study = shared / "study"
    activated = f". {shared}/flexmb/.venv/bin/activate\n"
    assert in_shell(activated + alone, study)[0] == 0
    expected = fastest(study / "study.h5")
    # The crank of 0.1 m carries the first point: its speed is 0.1 m times that of the driver.
    assert expected[::2] == pytest.approx([10.0, 12.5, 15.0, 17.5, 20.0], rel=1e-9)
    (study / "study.h5").unlink()
    kernels = "export NUMBA_CACHE_DIR=/shared/study/kernels"
    assert kernels in job and "flexmb compile\n" in job
    here = re.sub(rf"{kernels}.*\nflexmb compile\n", "flexmb compile --list > /dev/null\n", job)
    code, said = in_shell(here.replace("/shared", str(shared)), study)
    assert (code, fastest(study / "study.h5")) == (0, expected), said


def test_the_job_of_slurm_fails_where_the_study_fails(shared):
    """Its exit code was that of `kill`: 0."""
    pytest.importorskip("distributed")
    *_, job = programs(DOCS / "how-to/clusters.md")
    (shared / "study/IN-RSSR.dat").unlink()
    here = re.sub(r"export NUMBA_CACHE_DIR.*\nflexmb compile\n", "", job)
    code, said = in_shell(here.replace("/shared", str(shared)), shared / "study")
    assert code == 2 and "no such file" in said, said


def test_the_tolerances_of_the_page_are_read_and_win(tmp_path):
    """`types.acceleration = 2e-3` of OUT4-BAR.dat allows what its `last_digit = 1`, 1e-3, does not."""
    (text,) = programs(DOCS / "how-to/compare-in-ci.md")
    tomllib.loads(text)
    (tmp_path / "tolerances.toml").write_text(text)
    shutil.copy(TOP / "decks/young/IN4-BAR.dat", tmp_path)
    flexmb = [sys.executable, "-m", "flexmb_cli"]
    for folder in ("reference", "results"):
        subprocess.run([*flexmb, "run", "-q", "IN4-BAR.dat", "-o", folder], cwd=tmp_path, check=True)
    table = tmp_path / "results/OUT4-BAR.dat"
    lines = table.read_text().splitlines(keepends=True)
    at = next(k for k, line in enumerate(lines) if line.startswith("ACCELERATION")) + 4
    assert lines[at].split()[0] == "3"
    line, first = lines[at], lines[at].split()[1]
    for change, code in ((2e-3, 0), (3e-3, 1)):
        lines[at] = line.replace(first, f"{float(first) + change:.3f}", 1)
        table.write_text("".join(lines))
        compared = [*flexmb, "diff", "reference", "results", "--tolerances", "tolerances.toml"]
        done = subprocess.run(compared, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == code, done.stdout + done.stderr


def test_the_export_has_the_names_that_the_script_for_paraview_uses(tmp_path):
    (script,) = programs(DOCS / "how-to/paraview.md")
    page = (DOCS / "how-to/paraview.md").read_text(encoding="utf-8")
    (file,) = re.findall(r'OpenDataFile\("([^"]+)"\)', script)
    arrays = re.findall(r'[(\[]"POINTS", "(\w+)"[)\]]', page)
    assert arrays == ["von_mises", "deformation"]
    flexmb = [sys.executable, "-m", "flexmb_cli"]
    subprocess.run(
        [*flexmb, "run", "-q", str(TOP / "decks/vsdf/slider_crank_stress.vsdf")], cwd=tmp_path, check=True
    )
    subprocess.run([*flexmb, "export", "slider_crank_stress.h5", "--to", "vtkhdf"], cwd=tmp_path, check=True)
    with h5py.File(tmp_path / file) as data, h5py.File(tmp_path / "slider_crank_stress.h5") as result:
        assert set(arrays) <= set(data["VTKHDF/PointData"])
        # TimestepValues[-1] is the last instant; the array has the stress that the result has there.
        assert data["VTKHDF/Steps/Values"][-1] == result["time"][-1]
    table = re.findall(r"^\| `(\w+)` \| (\d) \|", page, re.MULTILINE)
    with h5py.File(tmp_path / file) as data:
        shapes = {name: data[f"VTKHDF/PointData/{name}"].shape[1:] for name, _ in table}
    assert shapes == {name: () if count == "1" else (int(count),) for name, count in table}
