"""The files for other people's CI: their steps are run here as far as no network is needed."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml
from pre_commit import clientlib

TOP = Path(__file__).resolve().parents[2]
SHIM = f'#!/bin/sh\nexec "{sys.executable}" -m flexmb_cli "$@"\n'
pytestmark = pytest.mark.processes


@pytest.fixture
def project(tmp_path):
    """A project with a deck and its references, and flexmb on the path; runs commands of a shell there."""
    (tmp_path / "bin").mkdir()
    for name, text in (("flexmb", SHIM), ("python", f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')):
        (tmp_path / "bin" / name).write_text(text)
        (tmp_path / "bin" / name).chmod(0o755)
    (tmp_path / "decks").mkdir()
    shutil.copy(TOP / "decks/young/IN4-BAR.dat", tmp_path / "decks")

    def shell(command, **environment):
        path = f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}"
        return subprocess.run(
            ["bash", "-e", "-c", command], cwd=tmp_path, capture_output=True, text=True, timeout=300,
            env=os.environ | {"PATH": path} | environment,
        )  # fmt: skip

    assert shell("flexmb run -q decks/*.dat -o reference").returncode == 0
    return tmp_path, shell


def spoil(path):
    """Change the first number below 10 with three decimals in a table."""
    text = path.read_text()
    path.write_text(re.sub(r"-2\.355\b", "-2.455", text, count=1))
    assert path.read_text() != text


def steps_of_action():
    """Names, shell commands and settings of the steps of the action."""
    action = yaml.safe_load((TOP / "action.yml").read_text())
    inputs = {name: given.get("default", "") for name, given in action["inputs"].items()}
    return inputs, [step for step in action["runs"]["steps"] if "run" in step]


def filled(text, inputs):
    """Put the inputs into the expressions, as GitHub does."""
    return re.sub(r"\$\{\{ inputs\.([\w-]+) \}\}", lambda match: inputs[match[1]], text)


def test_the_steps_of_the_action_run_and_compare(project):
    folder, shell = project
    inputs, steps = steps_of_action()
    inputs |= {"decks": "decks/*.dat", "reference": "reference"}
    assert [step["name"] for step in steps] == [
        "Install flexmb", "Run the decks", "Compare with the references",
    ]  # fmt: skip
    codes = []
    for spoiled in (False, True):
        if spoiled:
            spoil(folder / "reference/OUT4-BAR.dat")
        for step in steps[1:]:
            done = shell(step["run"], **{name: filled(text, inputs) for name, text in step["env"].items()})
            codes.append(done.returncode)
    assert codes == [0, 0, 0, 1]
    suite = ElementTree.parse(folder / "flexmb-diff.xml").getroot().find("testsuite")
    assert suite.get("failures") == "1"


def test_the_action_passes_tolerances_and_refuses_a_broken_deck(project):
    folder, shell = project
    inputs, steps = steps_of_action()
    (folder / "t.toml").write_text("[kinds]\nposition = 0.2\n")
    inputs |= {"decks": "decks/*.dat", "reference": "reference", "tolerances": "t.toml"}
    spoil(folder / "reference/OUT4-BAR.dat")
    environment = {name: filled(text, inputs) for step in steps[1:] for name, text in step["env"].items()}
    assert shell(steps[1]["run"], **environment).returncode == 0
    assert shell(steps[2]["run"], **environment).returncode == 0
    (folder / "decks/IN4-BAR.dat").write_text("nonsense")
    assert shell(steps[1]["run"], **environment).returncode == 2


def test_names_that_begin_with_a_dash_are_files_in_the_action_and_the_hook(project):
    """A deck `-q.dat` was taken for an option: `flexmb run` found no deck."""
    folder, shell = project
    inputs, steps = steps_of_action()
    (folder / "decks/IN4-BAR.dat").rename(folder / "-q.dat")
    (folder / "reference").rename(folder / "-r")
    for old, new in (("OUT4-BAR.dat", "-q.OUT"), ("OUT4-BAR.h5", "-q.h5")):
        (folder / "-r" / old).rename(folder / "-r" / new)
    inputs |= {"decks": "*.dat", "reference": "-r", "results": "-o", "junit": "-j.xml"}
    environment = {name: filled(text, inputs) for step in steps[1:] for name, text in step["env"].items()}
    assert [shell(step["run"], **environment).returncode for step in steps[1:]] == [0, 0]
    assert (folder / "-o/-q.OUT").exists() and (folder / "-j.xml").exists()
    (hook,) = yaml.safe_load((TOP / ".pre-commit-hooks.yaml").read_text())
    (folder / "-q.dat").write_text("nonsense")
    assert "-q.dat:1:1: error" in shell(f"{hook['entry']} -q.dat").stderr


def test_a_bad_deck_among_good_ones_is_marked_and_the_others_are_compared(project):
    """The comparison runs `always()`, so that the JUnit file is there when a deck has failed."""
    folder, shell = project
    inputs, steps = steps_of_action()
    (folder / "decks/IN-BAD.dat").write_text("nonsense")
    inputs |= {"decks": "decks", "reference": "reference"}
    assert steps[2]["if"].startswith("always() && ")
    environment = {name: filled(text, inputs) for step in steps[1:] for name, text in step["env"].items()}
    ran, compared = (shell(step["run"], GITHUB_ACTIONS="true", **environment) for step in steps[1:])
    assert (ran.returncode, compared.returncode) == (2, 0)
    assert "::error file=decks/IN-BAD.dat,title=DECK-013,line=1,col=1::no dialect begins" in ran.stderr
    assert re.search(
        r"^2 decks: 1 run, 1 failed; [\d.]+ s\n  decks/IN-BAD.dat: no dialect", ran.stderr, re.MULTILINE
    )
    suite = ElementTree.parse(folder / "flexmb-diff.xml").getroot().find("testsuite")
    assert (suite.get("tests"), suite.get("failures")) == ("2", "0")


def test_gitlab_compares_when_a_deck_has_failed(project):
    folder, shell = project
    job = yaml.safe_load((TOP / "docs/ci/gitlab-ci.yml").read_text())["flexmb"]
    script = "\n".join(line for line in job["script"] if "pip install" not in line)
    (folder / "decks/IN-BAD.dat").write_text("nonsense")
    assert shell(script).returncode == 2
    assert (folder / job["artifacts"]["reports"]["junit"]).exists()


def test_the_steps_of_gitlab_run_and_compare(project):
    folder, shell = project
    job = yaml.safe_load((TOP / "docs/ci/gitlab-ci.yml").read_text())["flexmb"]
    script = "\n".join(line for line in job["script"] if "pip install" not in line)
    assert shell(script).returncode == 0
    assert (folder / job["artifacts"]["reports"]["junit"]).exists()
    spoil(folder / "reference/OUT4-BAR.dat")
    assert shell(script).returncode == 1


@pytest.mark.parametrize(
    "own",
    ["", pytest.param("IN4-BAR", marks=pytest.mark.campaign)],
    ids=["references of all decks", "a folder for each deck"],
)
def test_decks_are_collected_as_tests(project, own):
    """The references are those that the first sentence of the page makes; a deck without any is skipped."""
    folder, shell = project
    decks = folder / "decks"
    shutil.copy(TOP / "docs/ci/conftest.py", decks)
    (decks / "reference").mkdir()
    shutil.copytree(folder / "reference", decks / "reference" / own, dirs_exist_ok=True)
    shutil.copy(TOP / "decks/young/IN1-1-1.dat", decks)
    pytest_here = "python -m pytest -p no:cacheprovider -q -rs decks"
    # CalculiX leaves OUT4-BAR.dat beside OUT4-BAR.inp, which was run as a deck.
    for suffix in (".inp", ".dat"):
        (decks / f"OUT4-BAR{suffix}").touch()
    done = shell(pytest_here)
    assert done.returncode == 0 and "1 passed, 1 skipped" in done.stdout, done.stdout
    assert "no references of IN1-1-1.dat" in done.stdout
    spoil(decks / "reference" / own / "OUT4-BAR.dat")
    done = shell(pytest_here)
    assert done.returncode == 1
    assert "numbers differ" in done.stdout and "body 2, X at t = 1.8" in done.stdout


def test_the_hook_checks_decks_by_their_names(project):
    _folder, shell = project
    (hook,) = yaml.safe_load((TOP / ".pre-commit-hooks.yaml").read_text())
    decks = [path.relative_to(TOP).as_posix() for path in (TOP / "decks").rglob("*") if path.is_file()]
    chosen = {name for name in decks if re.search(hook["files"], name)}
    assert chosen == {name for name in decks if name.endswith((".dat", ".DAT", ".vsdf"))}
    assert not re.search(hook["files"], "README.md") and not re.search(hook["files"], "data/other.dat")
    assert shell(f"{hook['entry']} decks/IN4-BAR.dat").returncode == 0
    assert shell(f"echo nonsense > decks/IN4-BAR.dat; {hook['entry']} decks/IN4-BAR.dat").returncode == 2
    assert clientlib.load_manifest(str(TOP / ".pre-commit-hooks.yaml"))[0]["id"] == "flexmb-check"


def test_the_image_installs_and_compiles_what_is_there():
    """Without Docker: the options that its lines give to flexmb and pip exist."""
    text = (TOP / "docs/ci/Dockerfile").read_text()
    extras = re.search(r"/src\[([\w,]+)\]", text)[1].split(",")
    known = (TOP / "pyproject.toml").read_text()
    assert all(re.search(rf"^{extra} = \[", known, re.MULTILINE) for extra in extras)
    assert "flexmb compile" in text and 'ENTRYPOINT ["flexmb"]' in text
    assert "--user" in text  # else results on a mounted folder belong to nobody
    assert re.search(r"^USER [1-9]", text, re.MULTILINE)
    # What is installed comes from files with the hashes of the lock, which holds all that these extras need.
    assert "--require-hashes -r /requirements.lock -d /wheels" in text
    assert "--no-index --find-links /wheels" in text and text.count("pip install") == 1


def shown_on_the_page():
    """The workflow for GitHub, with what the page leaves out, and the configuration of pre-commit."""
    page = (TOP / "docs/how-to/ci-files.md").read_text(encoding="utf-8")
    workflow, hooks = re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)
    return f"name: decks\non: push\n{workflow}", hooks


def test_the_workflow_and_the_hooks_of_the_page_fit_the_files():
    workflow, hooks = map(yaml.safe_load, shown_on_the_page())
    given = workflow["jobs"]["decks"]["steps"][1]["with"]
    inputs = yaml.safe_load((TOP / "action.yml").read_text())["inputs"]
    assert given.keys() <= inputs.keys()
    assert {name for name, described in inputs.items() if described.get("required")} <= given.keys()
    (offered,) = yaml.safe_load((TOP / ".pre-commit-hooks.yaml").read_text())
    assert [hook["id"] for hook in hooks["repos"][0]["hooks"]] == [offered["id"]]


@pytest.mark.parametrize(
    "schema, file",
    [
        ("vendor.gitlab-ci", "docs/ci/gitlab-ci.yml"),
        ("vendor.github-actions", "action.yml"),
        ("vendor.github-workflows", "workflow of the page"),
        ("vendor.citation-file-format", "CITATION.cff"),
    ],
)
def test_files_fit_the_schemas_of_schemastore(schema, file, tmp_path):
    path = TOP / file
    if not path.exists():
        path = tmp_path / "workflow.yml"
        path.write_text(shown_on_the_page()[0])
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", schema, str(path)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_hadolint_finds_nothing_in_the_dockerfile():
    hadolint = Path(sys.executable).with_name("hadolint")
    done = subprocess.run([hadolint, TOP / "docs/ci/Dockerfile"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_the_pages_show_the_files_themselves():
    page = (TOP / "docs/how-to/ci-files.md").read_text(encoding="utf-8")
    shown = re.findall(r"```\{literalinclude\} (\S+)", page)
    assert {Path(name).name for name in shown} == {"conftest.py", "Dockerfile", "gitlab-ci.yml"}
    assert all((TOP / "docs/how-to" / name).resolve().is_file() for name in shown)
    assert all(f"]({name})" in page for name in shown)  # a Git host shows no {literalinclude}


def test_no_version_is_named_that_no_tag_has():
    """`@v0.1.0` and `rev: v0.1.0` failed: the repository has no tags."""
    page = (TOP / "docs/how-to/ci-files.md").read_text(encoding="utf-8")
    named = re.findall(r"(?:flexmb@|rev: )(\S+)", page)
    assert named == ["COMMIT", "COMMIT"] and "git ls-remote" in page
