"""CONTRIBUTING.md: a joint, a card, a quantity and an integrator are added to a copy by the page."""

import csv
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from flexmb_cli.dialects.vsdf.form import NEWER
from tests.dialects.dafms.test_dafms_elements import TWO_LINKS, deck
from tests.house.contributions import (
    BEAD,
    CARD,
    CARD_OF_BODIES,
    DECK,
    FALLING,
    FORMAT,
    INTEGRATOR,
    JOINT,
    JOINT_OF_POINTS,
    KERNELS,
    LAW,
    ONPLANE,
    PENDULUM,
    PLANE,
    QUANTITY,
    READER,
    ROTOR,
    WHEEL,
)
from tests.house.test_house import MOST_FILES

ROOT = Path(__file__).resolve().parents[2]
TREE = TWO_LINKS.replace("1.000E-12    1.000E-13", "1.000E-07    1.000E-08")
# The word under which a recipe enters its line into a table.
ENTERED = re.compile(r'^ {4,8}(?:\w+\()?"([^"]+)"[,:]', re.MULTILINE)
TAKEN = "the package has it now: give that of tests/house/contributions.py another name"
pytestmark = pytest.mark.processes


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """A copy of the package with all five, and a deck."""
    folder = tmp_path_factory.mktemp("copy")
    shutil.copytree(ROOT / "flexmb_cli", folder / "flexmb_cli", ignore=shutil.ignore_patterns("__pycache__"))
    for name, origin in KERNELS.items():
        assert not (folder / name).parent.exists(), (name, TAKEN)
        (folder / name).parent.mkdir()
        (folder / name).with_name("__init__.py").touch()
        shutil.copy(ROOT / origin, folder / name)
    for recipe in (JOINT, JOINT_OF_POINTS, CARD, CARD_OF_BODIES, QUANTITY, INTEGRATOR, FORMAT, LAW):
        for name, additions in recipe.items():
            text = (folder / name).read_text(encoding="utf-8")
            for place, added in additions:
                assert text.count(place) == 1, (name, place)
                assert not [word for word in ENTERED.findall(added) if f'"{word}"' in text], (added, TAKEN)
                text = text.replace(place, added + place)
            (folder / name).write_text(text, encoding="utf-8")
    (folder / "flexmb_cli/kernels/kinematics/joints/onplane.py").write_text(ONPLANE)
    (folder / "flexmb_cli/fe/formats/triples.py").write_text(READER)
    (folder / "fall.vsdf").write_text(DECK)
    return folder


# One process for all commands: each would import the copy anew.
SERVER = """
import io, json, sys
from contextlib import redirect_stderr, redirect_stdout
from flexmb_cli.cli import main
for line in sys.stdin:
    words, answers = json.loads(line)
    given, said, failed = (io.TextIOWrapper(io.BytesIO(part)) for part in (answers.encode(), b"", b""))
    sys.argv, sys.stdin, code = ["flexmb", *words], given, 0
    with redirect_stdout(said), redirect_stderr(failed):
        try:
            main()
        except SystemExit as ending:
            code = ending.code or 0
    for stream in (said, failed):
        stream.seek(0)
    print(json.dumps([code, said.read(), failed.read()]), flush=True)
"""


@pytest.fixture(scope="module")
def flexmb(copy):
    """What the copy's flexmb answers, kernels interpreted."""
    given = os.environ | {"PYTHONPATH": str(copy), "NUMBA_DISABLE_JIT": "1", "FLEXMB_CACHE_DIR": str(copy)}
    command = [sys.executable, "-c", SERVER]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, cwd=copy, env=given, stdin=pipe, stdout=pipe, text=True) as server:

        def answered(*words, answers=""):
            server.stdin.write(json.dumps([words, answers]) + "\n")
            server.stdin.flush()
            code, said, failed = json.loads(server.stdout.readline())
            assert code == 0, failed
            return said

        yield answered
        server.stdin.close()


def test_as_few_files_are_touched_as_the_page_says():
    assert len(JOINT) <= 4 and len(JOINT_OF_POINTS) + 1 <= 3 and len(CARD) <= 3 and len(CARD_OF_BODIES) <= 3
    assert len(QUANTITY) <= 2 * 4 and len(KERNELS | INTEGRATOR) <= 3 and len(LAW) == 2
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert all(
        name.removeprefix("flexmb_cli/dialects/vsdf/").split("/")[-1] in page
        for name in JOINT | JOINT_OF_POINTS | CARD | CARD_OF_BODIES | QUANTITY | LAW
    )


def test_no_folder_is_crowded_by_what_the_page_adds(copy):
    folders = [path for path in (copy / "flexmb_cli").rglob("*/") if path.name != "__pycache__"]
    assert not [path for path in folders if sum(file.is_file() for file in path.iterdir()) > MOST_FILES]


def test_quantities_of_the_page_have_types(copy):
    """Strict mypy, by the settings of the project."""
    names = [name for name in QUANTITY if "/solvers/" in name]
    command = [
        sys.executable,
        "-m",
        "mypy",
        "--config-file",
        ROOT / "pyproject.toml",
        "--follow-imports=silent",
    ]
    done = subprocess.run([*command, *names], cwd=copy, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout


def test_a_joint_of_three_files_is_read_and_held(copy, flexmb):
    """The plane bears g cos 45° across it: x = g t²/4 and z = -g t²/4."""
    (copy / "plane.vsdf").write_text(DECK.replace("TIME\n", PLANE))
    flexmb("run", "-q", "plane.vsdf", "--no-out", "--h5", "plane.h5")
    table = flexmb("table", "plane.h5", "body.1.x", "body.1.z")
    rows = [[float(x) for x in row] for row in list(csv.reader(table.splitlines()))[1:]]
    expected = [9.5 / 4.0 * t * t for t, _, _ in rows]
    assert [x for _, x, _ in rows] == pytest.approx(expected, abs=1e-9)
    assert [-z for _, _, z in rows] == pytest.approx(expected, abs=1e-9)


def test_a_joint_that_another_dialect_has_not_is_not_converted(copy, flexmb):
    (copy / "plane.vsdf").write_text(DECK.replace("TIME\n", PLANE))
    with pytest.raises(AssertionError, match="joint 1: YOUNG has no point on plane joint"):
        flexmb("convert", "plane.vsdf", "--to", "young")


def test_a_spring_acts_in_the_only_coordinate_of_a_joint(copy, flexmb):
    """m s̈ = m g / √2 - c ṡ along the wire: s = (w t - w (1 - exp(-k t)) / k) / k, w = g / √2, k = c / m."""
    (copy / "bead.vsdf").write_text(DECK.replace("TIME\n", BEAD))
    flexmb("run", "-q", "bead.vsdf", "--no-out", "--h5", "bead.h5")
    rows = list(csv.reader(flexmb("table", "bead.h5", "body.1.x").splitlines()))[1:]
    w, k = 9.5 / np.sqrt(2.0), 1.5 / 2.0
    t, x = np.array(rows, float).T
    assert x == pytest.approx((w * t - w * -np.expm1(-k * t) / k) / k / np.sqrt(2.0), abs=1e-7)


def test_a_joint_of_points_is_compared_with_differences_unasked(copy):
    """In the copy: the tests of all joint types find it in `JOINT_TYPES`."""
    make_folders_of_tests(copy)
    shutil.copytree(ROOT / "tests/kernels/kinematics", copy / "tests/kernels/kinematics")
    shutil.copy(ROOT / "tests/solvers/kinematics/geometry.py", copy / "tests/solvers/kinematics")
    chosen = "-k", "onplane or one", "tests/kernels/kinematics/test_joint_properties.py"
    assert passed_in_copy(copy, *chosen) > 20


def make_folders_of_tests(copy):
    """Make packages of tests in the copy."""
    for name in (
        "__init__.py",
        "kernels/__init__.py",
        "kernels/constrained/__init__.py",
        "solvers/__init__.py",
        "solvers/kinematics/__init__.py",
    ):
        (copy / "tests" / name).parent.mkdir(parents=True, exist_ok=True)
        (copy / "tests" / name).touch()


def passed_in_copy(copy, *chosen):
    """Run tests in the copy; returns how many there are, which all pass."""
    given = os.environ | {"PYTHONPATH": str(copy), "NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *chosen]
    done = subprocess.run(command, cwd=copy, env=given, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout
    return int(done.stdout.split(" passed")[0].split()[-1])


def test_a_card_for_rigid_bodies_acts_on_them(copy, flexmb):
    """The centre of mass of the body is the joint: φ̈ = m g a / (m a² + Jyy) for the mass at a = 0.4 m."""
    (copy / "payload.vsdf").write_text(DECK.replace("TIME\n", PENDULUM))
    flexmb("run", "-q", "payload.vsdf", "--no-out", "--h5", "payload.h5")
    with h5py.File(copy / "payload.h5") as file:
        turning = file["body/angular_acceleration"][0, 0, 1]
    assert turning == pytest.approx(6.0 * 9.5 * 0.4 / (6.0 * 0.4**2 + 0.2), rel=1e-9)


def test_a_card_for_rigid_bodies_is_refused_for_others_and_for_bodies_that_there_are_not(copy, flexmb):
    (copy / "fe").mkdir()
    shutil.copy(ROOT / "decks/vsdf/fe/pendulum_nodes.txt", copy / "fe")
    text = (ROOT / "decks/vsdf/pendulum.vsdf").read_text()
    (copy / "rod.vsdf").write_text(
        text.replace("GRAV", "PAYL\n    1   51       6.0\n    2   51       6.0\nGRAV")
    )
    with pytest.raises(AssertionError) as refused:
        flexmb("check", "rod.vsdf")
    assert "PAYL is for RIGD bodies; body 1 is FLEX" in str(refused.value)
    assert "payload 2: body number 2 is outside 1..1" in str(refused.value)


def test_a_card_of_two_files_is_read_echoed_set_and_obeyed(copy, flexmb):
    """z = -g t²/2."""
    echo = [line.split() for line in flexmb("check", "fall.vsdf", "--echo").splitlines()]
    assert ["8", "weight.g", "9.5", "m/s^2", "gravity", "along", "-z"] in echo
    flexmb("run", "-q", "fall.vsdf", "--set", "weight.g=8", "--no-out", "--h5", "set.h5")
    rows = list(csv.reader(flexmb("table", "set.h5", "body.1.z").splitlines()))[1:]
    assert [float(z) for _, z in rows] == pytest.approx([-4.0 * float(t) ** 2 for t, _ in rows], abs=1e-12)


def test_answers_written_before_there_were_cards_still_give_a_deck(copy, flexmb):
    """Those of docs/how-to/type-a-deck.md, and the same with the new cards, whose counts come last."""
    page = (ROOT / "docs/how-to/type-a-deck.md").read_text(encoding="utf-8")
    written = page.partition("The same gate as a VSDF deck")[2].partition("```console\n$ ")[2]
    script, command = written.partition("\n```")[0].split(" > answers\n$ ")
    answers = subprocess.run(script, shell=True, text=True, capture_output=True, timeout=120).stdout
    assert command == "flexmb new vsdf -o - < answers | flexmb check - -q"
    # PAYL stands before ARMN among the cards that are as young, DOWN after all of them.
    before = [card.word for card in NEWER].index("ARMN")
    counts = f"{'0 ' * before}1{' 0' * (len(NEWER) - before)} 1"
    for more, words in (("", []), (f"\n{counts}\n1 3 6\n9.5\n", ["PAYL", "DOWN"])):
        typed = flexmb("new", "vsdf", "-o", "-", answers=answers + more)
        assert [word for word in typed.split() if word in ("PAYL", "DOWN")] == words
        (copy / "typed.vsdf").write_text(typed)
        flexmb("check", "-q", "typed.vsdf")


@pytest.fixture(scope="module")
def results(copy, flexmb):
    """The results of a deck of each analysis, and of a tree by both formulations, as {name: HDF5 file}."""
    elements = deck("ELEMENTS\n  SPRING s at=1.r3 stiffness=20 rest=0.2 damping=0.3 preload=1", TREE)
    decks = {
        "rotor.dat": ROTOR, "falling.dat": FALLING, "tree.DAT": deck("", TREE), "elements.DAT": elements,
        "fall.vsdf": DECK,
    }  # fmt: skip
    for name, text in decks.items():
        (copy / name).write_text(text)
    flexmb("run", "-q", "--no-out", *decks)
    flexmb("run", "-q", "--formulation", "absolute", "--no-out", "--h5", "absolute.h5", "tree.DAT")
    names = [*(Path(name).stem for name in decks), "absolute"]
    return {name: h5py.File(copy / f"{name}.h5") for name in names}, list(decks)


def test_quantities_of_kinematics_take_two_files(results):
    """A body at 0.5 m from its axis, 3 rad/s."""
    file = results[0]["rotor"]
    assert file["body/afar"][:, 1] == pytest.approx(0.5, abs=1e-12)
    assert file["body/whirl"][:, 1] == pytest.approx(3.0, abs=1e-12)
    assert file["body/afar"].attrs["units"] == "m"


def test_quantities_of_young_dynamics_take_two_files_and_know_the_masses(results):
    """p = m g t, T - V = m g² t², and those of kinematics."""
    file = results[0]["falling"]
    t = file["time"][:]
    assert file["system/impetus"][:, 1] == pytest.approx(-1.5 * 8.0 * t, abs=1e-9)
    assert file["energy/surplus"][:] == pytest.approx(1.5 * 64.0 * t * t, abs=1e-9)
    assert file["body/afar"][:, 1] == pytest.approx(4.0 * t * t, abs=1e-9)


@pytest.mark.parametrize("name", ["tree", "absolute", "elements"])
def test_quantities_of_trees_take_two_files_for_both_formulations(results, name):
    """By velocities and masses, 1.5 kg and 0.8 kg."""
    file = results[0][name]
    v = file["body/velocity"][:]
    assert np.abs(v[1:, 1]).max() > 0.1
    assert file["body/pace"][:] == pytest.approx(np.hypot(v[..., 0], v[..., 1]), abs=1e-12)
    assert file["system/impetus"][:] == pytest.approx(1.5 * v[:, 0] + 0.8 * v[:, 1], abs=1e-12)


def test_quantities_of_flexible_mechanisms_are_stored_named_and_listed(copy, flexmb, results):
    """|v| = g t, p = m g t."""
    head, *rows = csv.reader(flexmb("table", "fall.h5", "body.1.pace").splitlines())
    assert head == ["time [s]", "body.1.pace [m/s]"] and len(rows) == 6
    assert [float(v) for _, v in rows] == pytest.approx([9.5 * float(t) for t, _ in rows], abs=1e-12)
    assert "magnitude of the velocity" in flexmb("table", "fall.h5", "--list")
    file = results[0]["fall"]
    assert file["system/impetus"][:, 2] == pytest.approx(-2.0 * 9.5 * file["time"][:], abs=1e-12)


def test_verify_compares_analyses_with_quantities_added(copy, flexmb, results):
    flexmb("verify", "-q", "--rtol", "1e-8", *results[1][:-1])


def test_an_integrator_of_three_files_is_named_by_its_card(copy, flexmb):
    """Its formula has no error in a parabola, and Hermite's cubic has none between two steps."""
    text = DECK.replace("RK45", "RK4 ")
    (copy / "kutta.vsdf").write_text(text)
    flexmb("run", "-q", "kutta.vsdf", "--no-out", "--h5", "kutta.h5")
    rows = list(csv.reader(flexmb("table", "kutta.h5", "body.1.z").splitlines()))[1:]
    assert [float(z) for _, z in rows] == pytest.approx([-4.75 * float(t) ** 2 for t, _ in rows], abs=1e-12)
    unknown = DECK.replace("RK45", "RK5 ")
    (copy / "unknown.vsdf").write_text(unknown)
    with pytest.raises(AssertionError, match="RK4"):
        flexmb("check", "unknown.vsdf")


def test_a_new_integrator_takes_given_steps_and_is_an_option_of_two_dialects(copy, flexmb):
    """z = -g t²/2; `--strict` would refuse a step that is not used."""
    (copy / "steps.vsdf").write_text(
        DECK.replace("RK45", "RK4 ").replace("       0.1\n", "       0.1     0.025\n")
    )
    flexmb("check", "--strict", "steps.vsdf")
    (copy / "falling.dat").write_text(FALLING)
    for name, place, g in (("fall.vsdf", 2, 9.5), ("falling.dat", 1, 8.0)):
        flexmb("run", "-q", name, "--method", "rk4", "--no-out", "--h5", "option.h5")
        with h5py.File(copy / "option.h5") as file:
            assert file["options"].asstr()[()] if "options" in file else file.attrs["options"]
            expected = -0.5 * g * file["time"][:] ** 2
            assert file["body/position"][:, -1, place] == pytest.approx(expected, abs=1e-12)


def test_a_format_of_one_line_is_read_and_known_to_the_cards(copy):
    """Of a symmetric matrix one triangle stands in the file."""
    (copy / "K.txt").write_text("1 1 2.5\n2 1 -1\n2 2 4\n")
    program = (
        "from pathlib import Path\n"
        "from flexmb_cli.dialects.vsdf.card import MATRIX_FORMS\n"
        "from flexmb_cli.fe.formats.formats import read_matrix\n"
        "found = read_matrix(Path('K.txt'), 'TRI', 'K')\n"
        "print('TRI' in MATRIX_FORMS, found.size, *found.values.tolist())\n"
    )
    given = os.environ | {"PYTHONPATH": str(copy)}
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, cwd=copy, env=given, capture_output=True, text=True, timeout=120)
    assert done.stdout.split() == ["True", "2", "2.5", "-1.0", "4.0"], done.stderr


def motion_of_wheel(copy, flexmb, name):
    """Times, turns and rates of the wheel of a deck."""
    flexmb("run", "-q", name, "--no-out", "--h5", "wheel.h5")
    with h5py.File(copy / "wheel.h5") as result:
        omega = result["body/angular_velocity"][:, -1, 2]
        turn = 2.0 * np.arctan2(
            result["body/euler_parameters"][:, -1, 3], result["body/euler_parameters"][:, -1, 0]
        )
        return result["time"][:], turn, omega


@pytest.mark.parametrize("dialect", ["young", "vsdf", "dafms"])
def test_a_force_law_of_two_files_acts_in_every_dialect(copy, flexmb, dialect):
    """J w' = -c w²: w = 5 / (1 + 0.6 5 t / 0.8).  J w²/2 + k s⁴/4 stays for J w' = -k s³, s = turn - 0.2."""
    ending = {"young": "dat", "vsdf": "vsdf", "dafms": "DAT"}[dialect]
    for word, law in (
        ("square", "SQUARE s at=1.angle drag=0.6"),
        ("cube", "CUBE s at=1.angle stiffness=30 rest=0.2"),
    ):
        (copy / f"{word}.dat").write_text(f"{WHEEL}  {law}\nTOLERANCE 1e-11\nEND\n")
        if dialect != "young":
            flexmb("convert", f"{word}.dat", "--to", dialect, "-o", f"{word}.{ending}")
    t, _, omega = motion_of_wheel(copy, flexmb, f"square.{ending}")
    assert omega == pytest.approx(5.0 / (1.0 + 3.75 * t), rel=1e-8)
    _, turn, omega = motion_of_wheel(copy, flexmb, f"cube.{ending}")
    energy = 0.4 * omega**2 + 7.5 * (turn - 0.2) ** 4
    assert energy == pytest.approx(np.full(5, 10.0 + 7.5 * 0.2**4), rel=1e-7)
    assert np.ptp(omega) > 1.0


def test_a_force_law_is_compared_with_differences_and_its_code_unasked(copy):
    """In the copy, slopes and energy, dissipation and code: three tests a law."""
    make_folders_of_tests(copy)
    names = "kernels/test_laws.py", "kernels/constrained/test_load_codes.py", "naive/element_efforts.py"
    for name in names:
        (copy / "tests" / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / "tests" / name, copy / "tests" / name)
    laws, codes, _ = names
    assert passed_in_copy(copy, "-k", "SQUARE or CUBE or codes", f"tests/{laws}", f"tests/{codes}") >= 7


def test_a_force_law_of_two_files_takes_a_line_and_warns_of_a_sign(copy, flexmb):
    """m v' = m g - c v² gives v = w tanh(g t / w), w² = m g / c; a line away from the ground."""
    line = "ELEMENTS\n  SQUARE s from=0(0,5,0) to=2(0,0,0) drag="
    for drag in ("-0.6", "0.6"):
        (copy / "line.dat").write_text(FALLING.replace("END", f"{line}{drag}\nEND"))
        said = json.loads(flexmb("run", "--json", "line.dat", "--no-out", "--h5", "line.h5"))
        assert ("drag -0.6 is negative" in str(said["faults"])) == (drag == "-0.6")
    with h5py.File(copy / "line.h5") as result:
        t, v = result["time"][:], -result["body/velocity"][:, -1, 1]
    w = np.sqrt(1.5 * 8.0 / 0.6)
    assert v == pytest.approx(w * np.tanh(8.0 * t / w), abs=1e-7)


def test_units_of_a_force_law_follow_from_its_record(copy, flexmb):
    """0.6 N m s2/rad2 are 600 N mm s2/rad2."""
    (copy / "square.dat").write_text(f"{WHEEL}  SQUARE s at=1.angle drag=0.6\nEND\n")
    flexmb("convert", "square.dat", "--to", "young", "--to-unit", "mm", "-o", "mm.dat")
    (line,) = [line for line in (copy / "mm.dat").read_text().splitlines() if line.startswith("  SQUARE ")]
    assert float(line.rpartition("=")[2]) == pytest.approx(600.0)
