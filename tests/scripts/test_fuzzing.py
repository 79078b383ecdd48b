"""A small slice of scripts/fuzz, always with the same inputs: damaged files, files by grammar, long files."""

import subprocess
import sys
from fnmatch import fnmatch
from pathlib import Path

import h5py
import pytest

FUZZ = Path(__file__).parents[2] / "scripts" / "fuzz"

pytestmark = [
    pytest.mark.processes,
    pytest.mark.skipif(sys.platform != "linux", reason="limits of memory, and /proc"),
]


sys.path.insert(0, str(FUZZ))
from judged.decks import QUICK  # noqa: E402
from judged.judge import judge  # noqa: E402
from judged.young_text import read_young_text  # noqa: E402


def ran(script, *words):
    """What a script printed, when it ends with 0."""
    done = python(FUZZ / script, *words)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def python(*words):
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, timeout=300)


@pytest.mark.parametrize("kind", ["young-deck", "dafms-deck", "vsdf-deck", "study", "finite-element-file"])
def test_files_by_grammar_are_answered(kind):
    reported = ran("structure.py", "--count", "60", "--seed", "2", "--kind", kind, "--alone")
    assert " 60 files" in reported


def test_damaged_files_are_answered():
    kinds = ("young-deck", "study", "finite-element-file")
    reported = ran(
        "fuzz.py", "--count", "40", "--seed", "2", *(word for kind in kinds for word in ("--kind", kind))
    )
    assert "120 inputs, 0 not answered as they should be" in reported


def test_a_deck_that_is_not_answered_is_told_and_kept(tmp_path):
    """By a reader that can bear no deck."""
    code = (
        "import sys; sys.argv = ['structure.py', '--count', '60', '--kind', 'young-deck', '--alone', "
        f"'--keep', {str(tmp_path)!r}]\n"
        f"sys.path.insert(0, {str(FUZZ)!r})\n"
        "import structure, structure_kinds, damaged_decks\n"
        "original = damaged_decks.read_deck\n"
        "def spoiled(source):\n"
        "    original(source)\n"
        "    raise KeyError('spoiled')\n"
        "damaged_decks.read_deck = spoiled\n"
        "structure.PHASES = structure.PHASES[:1]\n"  # shrinking takes long
        "sys.exit(structure.main())\n"
    )
    done = python("-c", code)
    assert done.returncode == 1, done.stderr
    assert "KeyError: 'spoiled'" in done.stdout
    kept = (tmp_path / "structure-young-deck" / "x.deck").read_text()
    assert len(kept.splitlines()) >= 3


def test_without_atheris_the_script_says_so():
    code = (
        "import sys, runpy; sys.modules['atheris'] = None; sys.argv = ['coverage_guided.py']\n"
        f"sys.path.insert(0, {str(FUZZ)!r}); runpy.run_path({str(FUZZ / 'coverage_guided.py')!r}, "
        "run_name='__main__')"
    )
    done = python("-c", code)
    assert done.returncode == 2
    assert "atheris is not installed; is there a wheel for Python 3." in done.stderr


def test_damaged_decks_are_solved_as_the_judge_sees_it():
    reported = ran("solved.py", "--count", "30", "--seed", "3")
    assert "30 decks: " in reported and " solved" in reported and "; 0 wrong" in reported


def test_damaged_decks_with_elements_at_joints_are_solved_as_the_judge_sees_it():
    reported = ran("solved.py", "--elements", "--count", "12", "--seed", "1")
    assert "12 decks: " in reported and "rates of dafms" in reported and "; 0 wrong" in reported


UNSEEN = {"audit/newton_iterations", "audit/velocity_residual", "energy/applied_power"}


@pytest.mark.parametrize("name", ["IN4-BAR.dat", "dynamics/IN-BRICARD.dat"])
def test_the_judge_sees_a_change_of_a_thousandth_in_one_row_of_any_quantity(tmp_path, name):
    deck, result = FUZZ.parents[1] / "decks" / "young" / name, tmp_path / "r.h5"
    python("-m", "flexmb_cli", "run", deck, "--no-out", "--h5", result, "-q")
    text = read_young_text(deck.read_text())
    assert judge(result, text, warned=False) == ""
    with h5py.File(result) as file:
        count, found = len(file["time"]), []
        file.visititems(lambda path, item: found.append(path) if _moves(item, count) else None)
    assert {path for path in found if not _seen(result, path, text)} <= UNSEEN


def test_the_judge_sees_a_change_of_a_thousandth_in_one_row_of_a_tree(tmp_path):
    """Rows alone tell: places of the pivot at rest, turns, elastic motion of its point, energies."""
    deck, result = FUZZ.parents[1] / "decks" / "dafms" / "pendulum.DAT", tmp_path / "r.h5"
    words = (deck, "--no-out", "--h5", result, "-q", "--set", "time.IT=100")
    python("-m", "flexmb_cli", "run", *words)
    assert judge(result, None, warned=False) == ""
    with h5py.File(result) as file:
        count, found = len(file["time"]), []
        file.visititems(lambda path, item: found.append(path) if _moves(item, count) else None)
    unseen = {path for path in found if not _seen(result, path, None)}
    # The second formulation has no reactions of hinges.
    assert unseen <= {"coordinate/q", "elastic/body 1/displacement", "hinge/force", "hinge/torque"}


def test_the_judge_sees_a_hundredth_in_the_rates_of_a_finite_element_body(tmp_path):
    """Rows half a millisecond apart, as decks have them, show nothing of how such a body trembles."""
    deck, result = FUZZ.parents[1] / "decks" / "vsdf" / "freeflying.vsdf", tmp_path / "r.h5"
    (changes,) = (changes for pattern, _, changes in QUICK if fnmatch("vsdf/freeflying.vsdf", pattern))
    settings = [word for change in changes for word in ("--set", change)]
    python("-m", "flexmb_cli", "run", deck, "--no-out", "--h5", result, "-q", *settings)
    judged = []
    assert judge(result, None, warned=False, judged=judged) == "" and judged
    rates = ("body/velocity", "body/angular_velocity", "body/angular_acceleration", "point/acceleration")
    assert {path for path in rates if not _seen(result, path, None, slice(None), 1.01, 0.0)} == set()


def _moves(item, count):
    return isinstance(item, h5py.Dataset) and item.dtype.kind == "f" and item.shape[:1] == (count,)


def _seen(result, path, text, rows=None, factor=1.001, added=1e-3):
    """What the judge says of a result with other values in `rows`, by default in the middle one."""
    with h5py.File(result, "r+") as file:
        kept = file[path][()]
        rows = len(kept) // 2 if rows is None else rows
        file[path][rows] = kept[rows] * factor + added
    wrong = judge(result, text, warned=False)
    with h5py.File(result, "r+") as file:
        file[path][...] = kept
    return wrong
