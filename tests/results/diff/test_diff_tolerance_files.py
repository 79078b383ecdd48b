"""Tolerances by files and quantities, for folders of results."""

import re
import shutil
from pathlib import Path

import pytest

from flexmb_cli.results.diff.tolerance_file import read_tolerances
from flexmb_cli.results.diff.tolerances import Tolerances
from tests.results.diff.test_diff_folders import changed, compared, exported
from tests.results.results import write_result


def tolerances(tmp_path, text):
    path = tmp_path / "tolerances.toml"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("", 1),
        ("atol = 2e-3", 0),
        ("[kinds]\nposition = 2e-3", 0),
        ("[types]\nposition = 2e-3", 0),
        ("[types]\nvelocity = 2e-3", 1),
        ('[quantities]\n"body.3.x" = 2e-3', 0),
        ('[quantities]\n"body.*.x" = { atol = 2e-3, rtol = 1e-9 }', 0),
        ('[quantities]\n"body.3.y" = 2e-3', 1),
        ('[quantities]\n"body.3.position" = inf', 0),
        ('[files."one.h5"]\nkinds.position = 2e-3', 0),
        ('[files."one.h5".quantities]\n"body.3.x" = 2e-3', 0),
        ('[files."inner/*"]\ntypes.position = 2e-3', 1),
    ],
)
def test_tolerances_hold_for_their_files_and_quantities_only(text, code, folders, tmp_path):
    changed(folders[1] / "one.h5")
    changed(folders[1] / "inner/two.h5", by=0.0)
    assert compared(*folders, "--tolerances", tolerances(tmp_path, text)).exit_code == code


def test_a_tolerance_of_a_quantity_holds_for_tables_and_exports_too(tmp_path):
    result = write_result(tmp_path / "a.h5", 3)
    other = changed(shutil.copy(result, tmp_path / "b.h5"))
    wide = tolerances(tmp_path, '[quantities]\n"body.3.x" = 2e-3')
    (tmp_path / "narrow").mkdir()
    narrow = tolerances(tmp_path / "narrow", '[quantities]\n"body.3.x" = 5e-4')
    for form in ("csv", "mat"):
        assert compared(exported(result, form), other, "--tolerances", wide).exit_code == 0
        assert compared(exported(result, form), other, "--tolerances", narrow).exit_code == 1


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("atol = -1", "atol = -1: write a number not below zero"),
        ("last_digit = 1.5", "last_digit = 1.5: write a whole number not below zero"),
        ("tol = 1", "tol: there is no such setting"),
        ("[kinds]\nposotion = 1", "types.posotion: there is no such type"),
        ('[quantities]\n"body.1.x" = { abs = 1 }', "write atol, rtol or last_digit"),
        ('[quantities]\n"body.9.x" = 1', 'quantities "body.9.x"'),
        ('[files."tow.h5"]\natol = 1', 'files "tow.h5"'),
        ("files = 3", 'write a table of tolerances for each, [files."PATTERN"]'),
        ("atol =", "is not a TOML file: Invalid value"),
        # Found by fuzzing: a traceback each, or hours.
        ("atol = " + 5000 * "9", "is not a TOML file: Exceeds the limit"),
        ("kinds = " + 3000 * "[", "is not a TOML file: "),
        (
            ".".join(100_000 * "a") + " = 1",
            "is not a TOML file: a name of more than 64 parts (line 1, column 1)",
        ),
        ("atol = 1 # \0", "--tolerances: "),
    ],
    ids=lambda value: value[:30],
)
def test_a_tolerance_that_would_do_nothing_is_refused(text, reported, folders, tmp_path):
    done = compared(*folders, "--tolerances", tolerances(tmp_path, text))
    assert done.exception.exit_code == 2
    assert reported in str(done.exception)


def test_the_tolerances_shown_in_the_documentation_are_understood(folders, tmp_path):
    page = Path(__file__).resolve().parents[3] / "docs/how-to/compare-in-ci.md"
    shown = re.search(r"```toml\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)[1]
    read = read_tolerances(str(tolerances(tmp_path, shown)), Tolerances())
    special = read.of_file("OUT4-BAR.dat")
    assert (special.rtol, special.last_digit, special.of("acceleration").atol) == (1e-9, 1, 2e-3)
    assert special.named("velocity.body 3.dX").atol == 1e-3
    assert read.of_file("other.h5").last_digit == 0
