"""What a study asks for and its deck lacks: told at its line, numbers first, then quantities."""

import subprocess
import sys
from pathlib import Path

import pytest

from flexmb_cli import solve

DECK = Path(__file__).resolve().parents[2] / "decks/young/IN-RSSR.dat"
STUDY = f"""deck = "{DECK}"

[parameters]
"driver.1.B" = [100.0, 150.0]

[results]
top = "max point.1.z"
spin = "last body.2.omega.x"
"""


def flexmb(*arguments, **how):
    command = [sys.executable, "-m", "flexmb_cli", *arguments]
    return subprocess.run(command, capture_output=True, text=True, **how)


@pytest.fixture
def swept(tmp_path):
    """Runs a study with a text exchanged: exit code, standard error, and what lies in the folder then."""

    def run(old, new, *arguments):
        (tmp_path / "study.toml").write_text(STUDY.replace(old, new))
        done = flexmb("sweep", "study.toml", *arguments, cwd=tmp_path)
        return done.returncode, done.stderr, sorted(path.name for path in tmp_path.iterdir())

    return run


def test_unknown_quantities_are_told_at_their_lines(swept):
    code, reported, left = swept("max point.1.z", "max point.1.q")
    assert (code, left) == (2, ["study.toml"])
    assert reported.startswith(
        "study.toml:7:1: error: result top: point.1.q: the result has no such quantity"
    )
    assert '    top = "max point.1.q"\n    ^^^' in reported


def test_all_of_them_are_told_at_once(swept):
    _, reported, _ = swept("point.1.z", 'point.9.z"\nnone = "last elephant')
    assert [line.partition(" error")[0] for line in reported.splitlines() if "error" in line] == [
        "study.toml:7:1:",
        "study.toml:8:1:",
    ]


def test_an_unknown_parameter_is_told_at_its_line(swept):
    code, reported, left = swept("driver.1.B", "driver.9.B")
    assert (code, left) == (2, ["study.toml"])
    assert reported.startswith("study.toml:4:2: error: the deck has no number 'driver.9.B'; near it is")


def test_a_sample_without_a_count_is_told_where_the_sampling_stands(swept):
    code, reported, left = swept("[parameters]", 'sampling = "latin-hypercube"\n[parameters]')
    assert (code, left) == (2, ["study.toml"])
    assert (
        "study.toml:3:1: error: sampling: a latin-hypercube needs `count`, the number of its cases"
        in reported
    )


def test_a_deck_of_no_dialect_is_advised_as_a_study_can_say_it(swept):
    code, reported, _ = swept(str(DECK), str(Path(__file__).resolve()))
    assert code == 2 and 'dialect = "…" in the study chooses one' in reported and "--dialect" not in reported


def test_a_binary_file_and_a_folder_are_called_what_they_should_be(tmp_path):
    (tmp_path / "table.h5").write_bytes(b"\x89HDF\r\n\x1a\n\0\0")
    (tmp_path / "latin.toml").write_bytes(STUDY.replace("[results]", "# Gr\xf6\xdfe").encode("latin-1"))
    for name, message in (
        ("table.h5", "table.h5: error: this is not a study but an HDF5 file, as results are"),
        (".", ".: error: is a directory, not a study"),
        ("latin.toml", "latin.toml:6:5: error: the study is not UTF-8, which TOML has to be"),
    ):
        done = flexmb("sweep", name, "-o", "x.h5", cwd=tmp_path)
        assert done.returncode == 2 and done.stderr.startswith(message), done.stderr


def test_a_table_does_not_take_the_place_of_its_study(tmp_path):
    (tmp_path / "study.h5").write_text(STUDY)
    done = flexmb("sweep", "study.h5", cwd=tmp_path)
    assert done.returncode == 2 and "-o study.h5 would overwrite study.h5" in done.stderr
    assert (tmp_path / "study.h5").read_text() == STUDY


def test_a_study_on_standard_input_has_carets_and_a_table(tmp_path):
    wrong = flexmb("sweep", "-", cwd=tmp_path, input=STUDY.replace("driver.1.B", "driver.9.B"))
    assert wrong.returncode == 2
    assert wrong.stderr.startswith("-:4:2: error: the deck has no number 'driver.9.B'")
    assert '    "driver.9.B" = [100.0, 150.0]\n     ^' in wrong.stderr
    assert not list(tmp_path.iterdir())


def test_a_table_in_a_missing_folder_is_refused_and_none_is_made(swept):
    code, reported, left = swept("", "", "-o", "none/table.h5")
    assert (code, left) == (2, ["study.toml"])
    assert reported == "flexmb: error: none/table.h5: cannot be written: its folder does not exist\n"


def test_a_table_in_the_place_of_a_result_is_warned_of_before_it_is_solved(tmp_path):
    """arm.toml beside arm.vsdf replaced the result without a word; its own table it may replace."""
    (tmp_path / "study.toml").write_text(STUDY)
    solve(DECK).save(tmp_path / "study.h5")
    first, second = (flexmb("sweep", "study.toml", cwd=tmp_path).stderr.splitlines() for _ in range(2))
    assert first[0].startswith("study.toml: warning: study.h5 is the result of a run, which the table will")
    assert "-o gives the table a name" in first[0]
    assert len(first) == 2 and len(second) == 1
