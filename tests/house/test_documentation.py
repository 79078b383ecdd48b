"""Every command of README and docs runs as shown and prints what is shown; links, files and figures exist."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from flexmb_cli import solve
from flexmb_cli.run.convert import converted

pytestmark = pytest.mark.processes

TOP = Path(__file__).resolve().parents[2]
DOCS = TOP / "docs"
SHIM = f'#!/bin/sh\nexec "{sys.executable}" -m flexmb_cli "$@"\n'
MADE = {"_build", "gallery", "reproduced.md"}  # by the build of the documentation
PAGES = [
    TOP / "README.md",
    *sorted(page for page in DOCS.rglob("*.md") if not MADE & set(page.parts)),
    *sorted((TOP / "decks").rglob("*.md")),
    *(TOP / name for name in ("CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md")),
]


def named(page):
    return str(page.relative_to(TOP))


def transcripts(page):
    """Commands of all console blocks of a page in order, each with the lines shown below it."""
    for block in re.findall(r"```console\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL):
        for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            lines = part.rstrip("\n").split("\n")
            # A long command goes on after a stroke at the end of its line.
            end = 1 + next(n for n, line in enumerate(lines) if not line.endswith("\\"))
            yield "\n".join(lines[:end]), lines[end:]


def newcomer(folder):
    """Make `folder` look like a checkout with flexmb, the one under test, on the path."""
    (folder / "bin").mkdir()
    (folder / "bin" / "flexmb").write_text(SHIM)
    (folder / "bin" / "flexmb").chmod(0o755)
    (folder / "decks").symlink_to(TOP / "decks")
    return os.environ | {"PATH": f"{folder / 'bin'}{os.pathsep}{os.environ['PATH']}", "COLUMNS": "100"}


@pytest.mark.parametrize("page", [page for page in PAGES if any(transcripts(page))], ids=named)
def test_every_command_runs_and_prints_what_is_shown(page, tmp_path):
    environment = newcomer(tmp_path)
    for command, shown in transcripts(page):
        done = subprocess.run(
            command, shell=True, cwd=tmp_path, capture_output=True, text=True, encoding="utf-8",
            timeout=600, env=environment,
        )  # fmt: skip
        lines = [line for line in (done.stdout + done.stderr).splitlines() if "compiling kernels" not in line]
        assert lines[: len(shown)] == shown, f"{command}: where the change is meant, {named(page)} shows it"
        # A command that shows nothing is quiet because it succeeded.
        assert shown or (not lines and done.returncode == 0), command


def test_the_interface_prints_what_its_page_shows(tmp_path):
    page = (DOCS / "reference/python.md").read_text("utf-8")
    block, shown = re.search(r"```python\n(.*?)```.*?```text\n(.*?)```", page, re.DOTALL).groups()
    (tmp_path / "IN4-BAR.dat").write_bytes((TOP / "decks/young/IN4-BAR.dat").read_bytes())
    run = [sys.executable, "-c", block]
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=True, timeout=60)
    assert done.stdout == shown


def test_the_reading_examples_read_the_four_bar(tmp_path):
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / "how-to/python.md").read_text("utf-8"), re.DOTALL)
    run = [sys.executable, "-m", "flexmb_cli", "run", str(TOP / "decks/young/IN4-BAR.dat"), "-q"]
    subprocess.run(run, cwd=tmp_path, check=True, timeout=300)
    done = subprocess.run(
        [sys.executable, "-c", blocks[0]],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    # The range of z of body 3 in the published OUT4-BAR (tests/published/young/IN4-BAR.csv).
    assert done.stdout.splitlines() == [
        "complete",
        "26 rows, z of body 3 from 2.627 to 3.698 m",
        "all equations are met to round-off: True",
        "spherical 1",
        "universal 1",
        "revolute 1",
        "revolute 2",
    ]


def test_the_example_for_mujoco_finds_the_same_motion(tmp_path):
    """The tree by MuJoCo's own equations and RK4; 1e-10 m is what the page states for this deck."""
    page = (DOCS / "how-to/convert.md").read_text("utf-8")
    (block,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    deck = TOP / "decks/dafms/spatial_rigid.DAT"
    solve(deck).save(tmp_path / "spatial_rigid.h5")
    (tmp_path / "spatial_rigid.xml").write_text(converted(str(deck), "mjcf"))
    run = [sys.executable, "-c", block]
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=True, timeout=60)
    assert float(re.fullmatch(r"largest difference (\S+) m\n", done.stdout)[1]) < 1e-10


def test_every_supplied_deck_is_described_beside_it():
    for folder, pattern in (("young", "*.dat"), ("dafms", "*.DAT"), ("vsdf", "*.vsdf")):
        page = (TOP / "decks" / folder / "README.md").read_text(encoding="utf-8")
        for deck in (TOP / "decks" / folder).rglob(pattern):
            suffix = deck.stem.rpartition("_")[2]
            assert f"`{deck.stem}`" in page or f"`_{suffix}`" in page, deck


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_links_lead_to_files(page):
    for target in re.findall(
        r"\]\(([^)#]+)\)|^\{(?:include|figure|image)\} (\S+)", page.read_text("utf-8"), re.M
    ):
        path = target[0] or target[1]
        drawn = path.startswith(("pictures/", "../pictures/"))  # by the build of the documentation
        if not re.match(r"[a-z]+:", path) and not drawn:
            made = path.startswith("gallery/") or path.endswith("reproduced.md")
            assert made or (page.parent / path).exists(), path


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_files_of_the_package_that_are_named_exist(page):
    if page.name == "CHANGELOG.md":  # older entries name files as they were
        return
    for path in re.findall(r"`((?:flexmb_cli|scripts|tests|decks)/[\w./-]+)", page.read_text("utf-8")):
        assert (TOP / path).exists(), path


def test_the_readme_is_one_page():
    assert len((TOP / "README.md").read_text(encoding="utf-8").splitlines()) <= 150


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_no_machine_is_named(page):
    assert os.sep + "work" + os.sep not in page.read_text(encoding="utf-8")
