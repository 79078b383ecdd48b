"""The judge of damaged decks finds what was solved with other numbers than those of the deck."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
DECKS = ROOT / "decks"

pytestmark = [
    pytest.mark.processes,
    pytest.mark.skipif(sys.platform != "linux", reason="the scripts of the search run there"),
]

sys.path.insert(0, str(ROOT / "scripts" / "fuzz"))
from judged.dafms_text import read_dafms_text  # noqa: E402
from judged.judge import judge  # noqa: E402
from judged.rates import judge_rates  # noqa: E402
from judged.rows import Result  # noqa: E402
from judged.vsdf_text import read_vsdf_text  # noqa: E402
from judged.young_text import read_young_text  # noqa: E402

SHORT = ("    0.5    5.0E-4    5.0E-5", "  0.001    5.0E-5    5.0E-5")


def solved(folder, name, *changes):
    """The text of a supplied deck with changes of it, and its result."""
    text = (DECKS / name).read_text()
    for old, new in changes:
        assert text.count(old) == 1 and len(old) == len(new)
        text = text.replace(old, new)
    (folder / "fe").symlink_to(DECKS / "vsdf" / "fe")
    deck, result = folder / Path(name).name, folder / "r.h5"
    deck.write_text(text)
    command = [sys.executable, "-m", "flexmb_cli", "run", deck, "--no-out", "--h5", result, "-q"]
    subprocess.run(command, check=True, timeout=120)
    return text, result


def test_a_slider_moved_by_five_metres_along_its_guide_leaves_its_joints_open(tmp_path):
    """Its translational joint lets it slide: the spherical one at the flexible rod's node tells."""
    times = ("       0.5     0.005", "      0.05     0.005")
    text, result = solved(tmp_path, "vsdf/slider_crank_flex.vsdf", times)
    text = read_vsdf_text(text, tmp_path)
    assert judge(result, text, warned=False) == ""
    with h5py.File(result, "r+") as file:
        file["body/position"][:, 2, 0] += 5.0
        file["point/position"][:, 3, 0] += 5.0
    assert "gap of joint 3 (SPHE): 5" in judge(result, text, warned=False)


def test_a_finite_element_pendulum_in_half_the_gravity_has_other_potential_energies(tmp_path):
    text, result = solved(tmp_path, "vsdf/pendulum.vsdf", SHORT)
    assert judge(result, read_vsdf_text(text, tmp_path), warned=False) == ""
    (tmp_path / "half").mkdir()
    _, half = solved(tmp_path / "half", "vsdf/pendulum.vsdf", SHORT, ("     -9.81", "      -4.9"))
    assert "potential energy" in judge(half, read_vsdf_text(text, tmp_path), warned=False)


def test_an_elastic_pendulum_of_twice_the_stiffness_has_other_strain_energies(tmp_path):
    short = (" 6000\n", "   60\n")
    text, result = solved(tmp_path, "dafms/pendulum.DAT", short)
    assert judge(result, read_dafms_text(text), warned=False) == ""
    (tmp_path / "stiff").mkdir()
    _, stiff = solved(tmp_path / "stiff", "dafms/pendulum.DAT", short, ("         19.6\n", "         39.2\n"))
    assert "strain energy" in judge(stiff, read_dafms_text(text), warned=False)


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("       0.0       9.8\n", "       0.0       4.9\n", "potential energy"),
        ("INER\n    1      .018", "INER\n    1      .036", "kinetic energy"),
    ],
)
def test_weights_and_inertia_of_a_tree_are_those_of_its_deck(tmp_path, old, new, what):
    short = (" 6000\n", "   60\n")
    text, _ = solved(tmp_path, "dafms/pendulum.DAT", short)
    (tmp_path / "other").mkdir()
    _, other = solved(tmp_path / "other", "dafms/pendulum.DAT", short, (old, new))
    assert what in judge(other, read_dafms_text(text), warned=False)


def test_a_record_without_a_number_is_that_of_the_body_in_its_place(tmp_path):
    """The program of 1992 reads the records of a card in turn; flexmb does so where a number is blank."""
    changes = ((" 6000\n", "   60\n"), ("INER\n    1      .018", "INER\n           .018"))
    text, result = solved(tmp_path, "dafms/pendulum.DAT", *changes)
    assert judge(result, read_dafms_text(text), warned=False) == ""


def test_a_warning_excuses_the_drift_of_energy_that_it_states_and_no_more(tmp_path):
    _, result = solved(tmp_path, "dafms/pendulum.DAT", (" 6000\n", "   60\n"))
    with h5py.File(result, "r+") as file:
        for name in ("energy/total", "energy/potential"):
            file[name][30:] += 0.5
    assert judge(result, None, warned=0.5) == ""
    assert "the total energy strays by 0.5" in judge(result, None, warned=0.1)


def test_coarse_steps_still_show_velocities_that_are_not_those_of_the_places(tmp_path):
    """Velocities are doubled; accelerations, which coarse steps make, are not looked at."""
    _, result = solved(tmp_path, "dafms/pendulum.DAT", (" 6000\n", "   60\n"))
    assert judge(result, None, coarse=True) == ""
    with h5py.File(result, "r+") as file:
        file["point/velocity"][...] *= 2.0
    assert "point/position against its rates" in judge(result, None, coarse=True)


def test_rows_that_skip_whole_turns_show_no_rates(tmp_path):
    """A row for 16 turns looks like a slow motion backwards, at the speed that the deck prescribes."""
    _, result = solved(tmp_path, "dafms/pendulum.DAT", (" 6000\n", "   60\n"))
    with h5py.File(result, "r+") as file:
        rows = file["time"][...]
        file["body/angular_velocity"][:, 0] = (0.0, 0.0, 100.0 / np.diff(rows).max())
        file["body/position"][...] = np.sin(0.1 * np.arange(len(rows)))[:, None, None]
    assert not judge_rates(Result(result))


def test_a_load_on_one_body_leaves_the_balance_of_the_others(tmp_path):
    """A force of nothing on body 1 is a card that is not computed; joints elsewhere still have to balance."""
    text, result = solved(tmp_path, "young/dynamics/IN4-BAR-MASS.dat")
    text = read_young_text(text)
    loaded = replace(text, cards=(*text.cards, ("FORCE", [1.0, *[0.0] * 8])))
    assert judge(result, loaded) == ""
    elsewhere = [k for k, (_, joint) in enumerate(text.joints) if 1 not in joint[:2]]
    with h5py.File(result, "r+") as file:
        file["reaction/force"][:, elsewhere[0]] *= 1.5
    assert "balance of forces" in judge(result, loaded)


def test_blocks_that_the_judge_does_not_read_are_named():
    text = (ROOT / "scripts/fuzz/seeds/vsdf/elements.vsdf").read_text()
    assert "ELEM" in read_vsdf_text(text, ROOT).unread
    text = (ROOT / "scripts/fuzz/seeds/dafms/elements.DAT").read_text()
    assert "ELEM" in read_dafms_text(text).unread
