"""CONTRIBUTING.md: a joint, a card, a quantity and an integrator are added to a copy by the page."""

import csv
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# (a) A point on a plane of the other body.
JOINT = {
    "flexmb_cli/model/joints.py": (
        '    JointType("revolute-spherical",',
        '    JointType("point on plane", 0, 1, (*_P, "Q_i"), meets=False),\n',
    ),
    "flexmb_cli/model/arrays/node_joints.py": (
        '    "revolute-spherical": (_in_plane,',
        '    "point on plane": (_in_plane,),\n',
    ),
    "flexmb_cli/dialects/vsdf/__init__.py": (
        '        "RSPH": "revolute-spherical",',
        '        "PLAN": "point on plane",\n',
    ),
}
# (b) By file: where in it, and what is put there.  Gravity by its strength alone, downwards.
CARD = {
    "flexmb_cli/dialects/vsdf/cards/joints_and_loads.py": (
        '    Card("GRAV", ',
        '    Card("DOWN", "weight", "DOWN", "single", (Column("g", "gravity along -z", "m/s^2"),)),\n',
    ),
    "flexmb_cli/dialects/vsdf/build.py": (
        "    return VsdfModel(",
        '    if weight := values.record("weight"):\n        g = (0.0, 0.0, -float(weight["g"]))\n',
    ),
}
# (c) The speed of the origin of every body.
QUANTITY = {
    "flexmb_cli/solvers/constrained/flexible_rows.py": (
        "    @property\n    def total(self)",
        "    @property\n    def speed(self) -> np.ndarray:\n"
        '        """Magnitude of the velocity (T, b), m/s."""\n'
        "        return np.linalg.norm(self.velocity, axis=-1)\n\n",
    ),
    "flexmb_cli/results/hdf5/flexible.py": (
        '    "kinetic": Series(',
        '    "speed": Series("body/speed", ("body/body",), "m/s", "magnitude of the velocity"),\n',
    ),
}
# (d) The classical method of order 4, besides a file of its kernels.
KERNELS = {"flexmb_cli/kernels/integrators/rk4.py": "tests/kernels/integrators/rk4.py"}
INTEGRATOR = {
    "flexmb_cli/kernels/signatures.py": (
        '    "alpha": {',
        '    "rk4": {"integrators.rk4.integrate_rows": "int System Work Integration Report int"},\n',
    ),
    "flexmb_cli/solvers/constrained/integrators.py": (
        '    "RK45": Method(',
        '    "RK4": Method("Kutta", lambda tolerance, length: Steps("rk4"), 1e-8),\n',
    ),
}
# (f) Lines of row, column (from 1) and value.
READER = '''"""Lines of row, column and value."""

import numpy as np

from .matrix_file import MatrixFile


def read_triples(path):
    """Return the matrix of a file."""
    rows, columns, values = np.loadtxt(path, ndmin=2).T
    size = int(max(rows.max(), columns.max()))
    return MatrixFile(size, rows.astype(int) - 1, columns.astype(int) - 1, values, True)
'''
FORMAT = {
    "flexmb_cli/fe/formats/formats.py": (
        '    "MM": MatrixFormat(',
        '    "TRI": MatrixFormat("triples:read_triples"),\n',
    ),
}
# A body of 2 kg that falls; the method of order 8 has no error in a parabola.
DECK = """\
VSDF A BODY THAT FALLS
BODY
    1 RIGD
RIGI
    1       2.0       0.0       0.0       0.0
       0.1       0.2       0.3       0.0       0.0       0.0
DOWN
       9.5
TIME
       0.5       0.1
INTG
 RK45    1.0E-8
END
STAR
STOP
"""

# The mass centre on the plane through the origin whose normal is (1, 0, 1).
PLANE = """\
NODE
    0    1       0.0       0.0       0.0
    0    2       1.0       0.0       1.0
    1    3       0.0       0.0       0.0
JOIN
    1 PLAN    0    1    2    1    3
TIME
"""

pytestmark = pytest.mark.processes


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """A copy of the package with all five, and a deck."""
    folder = tmp_path_factory.mktemp("copy")
    shutil.copytree(ROOT / "flexmb_cli", folder / "flexmb_cli", ignore=shutil.ignore_patterns("__pycache__"))
    for name, origin in KERNELS.items():
        shutil.copy(ROOT / origin, folder / name)
    for name, (place, added) in (JOINT | CARD | QUANTITY | INTEGRATOR | FORMAT).items():
        text = (folder / name).read_text(encoding="utf-8")
        assert text.count(place) == 1
        (folder / name).write_text(text.replace(place, added + place), encoding="utf-8")
    (folder / "flexmb_cli/fe/formats/triples.py").write_text(READER)
    (folder / "fall.vsdf").write_text(DECK)
    return folder


def flexmb(copy, *words):
    """What the copy's flexmb answers, kernels interpreted."""
    given = os.environ | {"PYTHONPATH": str(copy), "NUMBA_DISABLE_JIT": "1", "FLEXMB_CACHE_DIR": str(copy)}
    command = [sys.executable, "-m", "flexmb_cli", *words]
    done = subprocess.run(command, cwd=copy, env=given, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_as_few_files_are_touched_as_the_page_says():
    assert len(JOINT) <= 4 and len(CARD) <= 3 and len(QUANTITY) <= 2 and len(KERNELS | INTEGRATOR) <= 3
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert all(
        name.removeprefix("flexmb_cli/dialects/vsdf/").split("/")[-1] in page
        for name in JOINT | CARD | QUANTITY
    )


def test_a_joint_of_three_files_is_read_and_held(copy):
    """The plane bears g cos 45° across it: x = g t²/4 and z = -g t²/4."""
    (copy / "plane.vsdf").write_text(DECK.replace("TIME\n", PLANE))
    flexmb(copy, "run", "-q", "plane.vsdf", "--no-out", "--h5", "plane.h5")
    table = flexmb(copy, "table", "plane.h5", "body.1.x", "body.1.z")
    rows = [[float(x) for x in row] for row in list(csv.reader(table.splitlines()))[1:]]
    expected = [9.5 / 4.0 * t * t for t, _, _ in rows]
    assert [x for _, x, _ in rows] == pytest.approx(expected, abs=1e-9)
    assert [-z for _, _, z in rows] == pytest.approx(expected, abs=1e-9)


def test_a_card_of_two_files_is_read_echoed_set_and_obeyed(copy):
    """z = -g t²/2."""
    echo = [line.split() for line in flexmb(copy, "check", "fall.vsdf", "--echo").splitlines()]
    assert ["8", "weight.g", "9.5", "m/s^2", "gravity", "along", "-z"] in echo
    flexmb(copy, "run", "-q", "fall.vsdf", "--set", "weight.g=8", "--no-out", "--h5", "set.h5")
    rows = list(csv.reader(flexmb(copy, "table", "set.h5", "body.1.z").splitlines()))[1:]
    assert [float(z) for _, z in rows] == pytest.approx([-4.0 * float(t) ** 2 for t, _ in rows], abs=1e-12)


def test_a_quantity_of_two_files_is_stored_named_and_listed(copy):
    """|v| = g t."""
    flexmb(copy, "run", "-q", "fall.vsdf", "--no-out", "--h5", "fall.h5")
    head, *rows = csv.reader(flexmb(copy, "table", "fall.h5", "body.1.speed").splitlines())
    assert head == ["time [s]", "body.1.speed [m/s]"] and len(rows) == 6
    assert [float(v) for _, v in rows] == pytest.approx([9.5 * float(t) for t, _ in rows], abs=1e-12)
    assert "magnitude of the velocity" in flexmb(copy, "table", "fall.h5", "--list")


def test_an_integrator_of_three_files_is_named_by_its_card(copy):
    """Its formula has no error in a parabola, and Hermite's cubic has none between two steps."""
    text = DECK.replace("RK45", "RK4 ")
    (copy / "kutta.vsdf").write_text(text)
    flexmb(copy, "run", "-q", "kutta.vsdf", "--no-out", "--h5", "kutta.h5")
    rows = list(csv.reader(flexmb(copy, "table", "kutta.h5", "body.1.z").splitlines()))[1:]
    assert [float(z) for _, z in rows] == pytest.approx([-4.75 * float(t) ** 2 for t, _ in rows], abs=1e-12)
    unknown = DECK.replace("RK45", "RK5 ")
    (copy / "unknown.vsdf").write_text(unknown)
    with pytest.raises(AssertionError, match="RK4"):
        flexmb(copy, "check", "unknown.vsdf")


def test_a_format_of_one_line_is_read_and_known_to_the_cards(copy):
    """Of a symmetric matrix one triangle stands in the file."""
    (copy / "K.txt").write_text("1 1 2.5\n2 1 -1\n2 2 4\n")
    program = (
        "from pathlib import Path\n"
        "from flexmb_cli.dialects.vsdf.cards.columns import MATRIX_FORMS\n"
        "from flexmb_cli.fe.formats.formats import read_matrix\n"
        "found = read_matrix(Path('K.txt'), 'TRI', 'K')\n"
        "print('TRI' in MATRIX_FORMS, found.size, *found.values.tolist())\n"
    )
    given = os.environ | {"PYTHONPATH": str(copy)}
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, cwd=copy, env=given, capture_output=True, text=True, timeout=120)
    assert done.stdout.split() == ["True", "2", "2.5", "-1.0", "4.0"], done.stderr
