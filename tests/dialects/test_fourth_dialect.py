"""A dialect is its folder and one line: every command takes decks of one that this program never saw."""

import json
import math

import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.dialects import DIALECTS

MASS, LENGTH, ANGLE, GRAVITY = 2.0, 0.5, 1.2, 9.81


def half_period():
    """T / 2 of large swings: π √(l/g) / agm(1, cos θ/2), exact (Gauss)."""
    a, b = 1.0, math.cos(ANGLE / 2)
    for _ in range(6):
        a, b = (a + b) / 2, math.sqrt(a * b)
    return math.pi * math.sqrt(LENGTH / GRAVITY) / a


DECK = f"""a pendulum
mass = {MASS}
length = {LENGTH}
angle = {ANGLE}
end = {half_period():.17g}
step = {half_period() / 4:.17g}
"""


@pytest.fixture
def deck(tmp_path, monkeypatch):
    monkeypatch.setitem(DIALECTS, "swing", ("tests.dialects.swing", "a pendulum"))
    path = tmp_path / "bob.txt"
    path.write_text(DECK)
    return path


def command(*words, code=0):
    done = CliRunner().invoke(cli, [str(word) for word in words])
    assert done.exit_code == code, done.output
    return done


def test_check_reads_builds_and_assembles_it(deck):
    found = json.loads(command("check", "--json", deck).stdout)
    assert (found["dialect"], found["status"], found["counts"]["bodies"]) == ("swing", "complete", 2)
    assert found["counts"]["degrees_of_freedom"] == 1
    echo = command("check", "--echo", deck).stdout
    assert "read as a SWING deck, which begins with the words a pendulum" in echo
    assert "bob.length" in echo


def test_run_writes_its_table_log_and_result_and_swings_in_the_exact_time(deck, tmp_path):
    command("run", deck, "-o", tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"bob.txt", "bob.OUT", "bob.h5", "bob.log"}
    first, *_, last = (tmp_path / "bob.OUT").read_text().splitlines()[1:]
    (x, y), (x_end, y_end) = ([float(word) for word in line.split()[1:]] for line in (first, last))
    assert (x, y) == pytest.approx((LENGTH * math.sin(ANGLE), -LENGTH * math.cos(ANGLE)), abs=1e-6)
    assert (x_end, y_end) == pytest.approx((-x, y), abs=2e-6)


def test_set_changes_its_numbers_and_resume_and_sweeps_know_nothing_of_dialects(deck, tmp_path):
    command("run", deck, "-o", tmp_path, "--set", "bob.angle=0.1", "--resume")
    assert (tmp_path / "bob.OUT").read_text().splitlines()[1].split()[1] == f"{LENGTH * math.sin(0.1):.6f}"
    study = tmp_path / "study.toml"
    study.write_text(
        'deck = "bob.txt"\n[parameters]\n"bob.mass" = [1.0, 3.0]\n[results]\nlow = "min point.1.y"\n'
    )
    command("sweep", study, "-o", tmp_path / "study.h5", "-j", "1")


def test_diff_compares_its_tables(deck, tmp_path):
    for folder, angle in (("a", "1.2"), ("b", "1.2"), ("c", "1.1")):
        command("run", deck, "-o", tmp_path / folder, "--set", f"bob.angle={angle}")
    a, b, c = (tmp_path / folder / "bob.OUT" for folder in "abc")
    command("diff", a, b)
    assert "bob" in command("diff", a, c, code=1).stdout


def test_table_and_the_page_know_its_results(deck, tmp_path):
    command("run", deck, "-o", tmp_path)
    table = command("table", tmp_path / "bob.h5", "point.1.x").stdout.splitlines()
    assert len(table) == 6
    assert float(table[1].split(",")[-1]) == pytest.approx(LENGTH * math.sin(ANGLE), abs=1e-9)


def test_two_formulations_agree_on_it(deck):
    command("verify", deck)


def test_options_of_other_dialects_have_no_effect_on_it(deck, tmp_path):
    reported = command("run", deck, "-o", tmp_path, "--feps", "1e-6").stderr
    assert "--feps has no effect on this SWING deck" in reported


def test_a_file_that_no_dialect_knows_is_told_what_each_looks_for(deck):
    reported = command("diff", deck, deck, code=2).stderr
    assert "no table of a pendulum" in reported and "no echo of a DAFMS deck" in reported
