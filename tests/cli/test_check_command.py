"""`flexmb check` and what `run` echoes, in processes of their own."""

import pytest

from tests.cli.test_command_line import FOUR_BAR, HELD, TOP, flexmb

pytestmark = pytest.mark.processes


def test_check_writes_nothing_and_names_a_free_motion(tmp_path):
    # The RSSR without its constraint on the coupler's spin: a second hold of the ground takes its place.
    deck = (TOP / "decks/young/IN-RSSR.dat").read_text().replace("\n3 5 0\n", "\n2 2 -0.06567\n")
    done = flexmb("check", "-", cwd=tmp_path, stdin=deck)
    assert done.returncode == 2
    assert "body 3 can turn about" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_check_prints_every_number_with_its_name(tmp_path):
    done = flexmb("check", FOUR_BAR, "--echo", cwd=tmp_path)
    assert done.returncode == 0
    for name in (
        "counts.NBODY",
        "body.2.e3",
        "driver.1.B",
        "universal.1.Q_j.z",
        "ground.1.gamma",
        "time.step",
    ):
        assert f" {name} " in done.stdout


def test_the_labelled_jacobian_is_that_of_table_6_1(tmp_path):
    """Young (1996), table 6.1: row 7 at the deck's estimates, rows 11, 12 and 18, 19.

    Row 7 is printed with lost signs and digits; the exact figures are those of its recomputation,
    -1.36 -0.90 -1.02 0.54 for body 1 and -0.80 0.77 1.66 -0.07 for body 2.
    """
    done = flexmb("check", FOUR_BAR, "--jacobian", "estimate", cwd=tmp_path)
    rows = {int(line.split()[0]): line for line in done.stdout.splitlines() if line.lstrip()[:1].isdigit()}
    cells = {k: line[47:].replace(".  ", "0  ").split() for k, line in rows.items()}
    row = [0.0 if cell == "." else float(cell) for cell in cells[7]]
    assert [round(v, 2) for v in row[3:7]] == [-1.36, -0.90, -1.02, 0.54]
    assert [round(v, 2) for v in row[10:14]] == [-0.80, 0.77, 1.66, -0.07]
    assert "revolute joint 1, s_i × s_j, 1st" in rows[11]
    assert "-2.0000" in rows[11]
    assert "-2.0000" in rows[12]
    assert "driver 1, e1" in rows[18]
    assert "driver 1, e0" in rows[19]


@pytest.mark.parametrize("time", ["1_000", "\uff13", "nan", "soon", ""])
def test_a_time_of_the_jacobian_is_spelled_as_in_decks(tmp_path, time):
    done = flexmb("check", FOUR_BAR, "--jacobian", time, cwd=tmp_path)
    assert done.returncode == 2
    assert "is neither a time in s nor 'estimate'" in done.stderr


def test_a_jacobian_of_a_time_that_is_hours_of_computing_away_is_refused(tmp_path):
    done = flexmb("check", FOUR_BAR, "--jacobian", "1e8", cwd=tmp_path)
    assert done.returncode == 2
    assert "--jacobian 1e+08: later than 100000 of the deck's steps" in done.stderr


def test_what_cannot_share_standard_output_is_refused(tmp_path):
    for options, objects in ((["--out", "-", "--json"], 1), (["--h5", "-"], 0)):
        done = flexmb("run", HELD, *options, cwd=tmp_path)
        assert (done.returncode, len(done.stdout.splitlines())) == (2, objects)
        assert "standard output" in done.stderr


def test_the_echo_of_standard_input_is_that_of_the_deck_run(tmp_path):
    done = flexmb("run", "-", "--echo", cwd=tmp_path, stdin=HELD.read_text())
    assert done.returncode == 0
    assert " time.step " in done.stderr


def test_the_echo_is_there_with_several_jobs(tmp_path):
    done = flexmb("run", HELD, FOUR_BAR, "--echo", "-j", 2, cwd=tmp_path)
    assert done.stderr.count(" counts.NBODY ") == 2
