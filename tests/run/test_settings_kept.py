"""What `--set` changed of a deck stands wherever the result is told of."""

import json
import subprocess
import sys
from pathlib import Path

import h5py
import pytest

pytestmark = pytest.mark.processes

DECKS = Path(__file__).resolve().parents[2] / "decks"
CHANGES = ["point.1.x=0.25", "time.end = 2"]
KEPT = ["point.1.x=0.25", "time.end=2"]


def flexmb(*arguments, cwd):
    command = [sys.executable, "-m", "flexmb_cli", *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A run as the deck has it, and a changed one with its JSON record."""
    folder = tmp_path_factory.mktemp("settings")
    deck = DECKS / "young/IN1-3-1.dat"
    flexmb("run", deck, "-q", "--no-out", "--h5", "plain.h5", cwd=folder)
    settings = [word for change in CHANGES for word in ("--set", change)]
    done = flexmb("run", deck, *settings, "-q", "--json", "--no-out", "--h5", "changed.h5", cwd=folder)
    (folder / "changed.json").write_text(done.stdout)
    return folder


def test_the_result_has_them_in_their_order_and_none_without(folder):
    with h5py.File(folder / "plain.h5") as plain, h5py.File(folder / "changed.h5") as changed:
        assert "settings" not in plain.attrs
        assert changed.attrs["settings"].splitlines() == KEPT
        assert plain.attrs["deck_sha256"] == changed.attrs["deck_sha256"]


def test_json_has_them(folder):
    assert json.loads((folder / "changed.json").read_text())["settings"] == KEPT
    done = flexmb("check", DECKS / "young/IN1-3-1.dat", "--json", "--set", CHANGES[0], cwd=folder)
    assert json.loads(done.stdout)["settings"] == KEPT[:1]


def test_the_list_of_quantities_notes_them(folder):
    changed, plain = (flexmb("table", name, "--list", cwd=folder) for name in ("changed.h5", "plain.h5"))
    assert changed.stderr == f"changed.h5: note: the run changed the deck by --set: {', '.join(KEPT)}\n"
    assert plain.stderr == "" and plain.stdout == changed.stdout


def test_the_report_shows_them_and_echoes_what_was_run(folder):
    from flexmb_cli.results.figures.report_page import report_page
    from flexmb_cli.results.quantities.quantities import open_result

    def page(name):
        with open_result(folder / name) as result:
            return report_page(result)

    changed, plain = page("changed.h5"), page("plain.h5")
    assert f"changed for this run by --set: <b>{', '.join(KEPT)}</b>" in changed and "--set" not in plain
    rows = [line.split()[:3] for line in changed.partition('id="echo"')[2].splitlines()]
    assert ["--set", "point.1.x", "0.25"] in rows and ["--set", "time.end", "2"] in rows


@pytest.mark.parametrize(
    "deck, given, kept",
    [
        ("young/IN1-3-1.dat", ["--feps", "1e-5", "--nrmax", "30"], "feps=1e-05\nnrmax=30"),
        ("dafms/pendulum.DAT", ["--rtol", "1e-6", "--method", "radau"], "rtol=1e-06\nmethod=radau"),
        ("dafms/pendulum.DAT", ["--formulation", "absolute"], "formulation=absolute"),
        ("young/IN1-3-1.dat", ["--rtol", "1e-6"], None),
    ],
)
def test_options_on_which_numbers_depend_are_kept_where_they_have_an_effect(tmp_path, deck, given, kept):
    flexmb("run", DECKS / deck, *given, "-q", "--no-out", "--h5", "r.h5", cwd=tmp_path)
    with h5py.File(tmp_path / "r.h5") as result:
        assert result.attrs.get("options") == kept


@pytest.mark.parametrize(
    "deck, change", [("dafms/pendulum", "time.IT=2"), ("vsdf/pendulum", "time.end=0.001")]
)
def test_the_other_dialects_keep_them_too(tmp_path, deck, change):
    path = DECKS / f"{deck}.{'DAT' if deck.startswith('dafms') else 'vsdf'}"
    flexmb("run", path, "--set", change, "-q", "--no-out", "--h5", "r.h5", cwd=tmp_path)
    with h5py.File(tmp_path / "r.h5") as result:
        assert result.attrs["settings"] == change
