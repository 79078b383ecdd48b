"""Problems of `reference/motion` on drag, expressions and reactions of trees, with their tolerances."""

import h5py
import numpy as np
import pytest

from flexmb_cli.interface import solve_to_files
from flexmb_cli.run.outcome import RunOptions

pytestmark = pytest.mark.long_motion

# A body that slides along z of a grounded one (body 1), or turns about its z.
SLIDE = (
    "2 0 0 0 0 0 0 1 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n"
    "1 2 0 0 0 0 0 0 0 0 1 0 0 1 1 0 0 0 1 0\n1 0 0 0 0 0 0\n"
)
ROTOR = "2 0 0 0 0 1 0 0 0 0 0 1\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n1 2 0 0 0 0 0 0 0 0 1 0 0 1\n1 0 0 0 0 0 0\n"
# The size of a rate is the rate, or its opposite below 0.
DRAG = (
    "  SIGNAL v sum 1.{0}.rate\n  SIGNAL back sum -1*1.{0}.rate\n"
    "  SIGNAL size switch of=v level=0 below=back above=v\n"
    "  SIGNAL drag product {1} size v\n  MOTOR air at=1.{0} effort=drag\n  START at=1.{0} rate={2}\n"
)


def run(folder, name, text, **options):
    (folder / name).write_text(text)
    settings = RunOptions(folder=str(folder), no_out=True, h5=str(folder / "x.h5"), **options)
    outcome = solve_to_files(folder / name, settings)
    assert outcome.exit_code == 0, [fault.message for fault in outcome.faults]
    return h5py.File(folder / "x.h5")


def test_a_throw_against_quadratic_drag(tmp_path):
    """drag-quadratic, case 1: closed form, tan and tanh."""
    drag = DRAG.format("stroke", -0.25, 90)
    text = (
        f"{SLIDE}0 30 1\nDYNAMICS forward\nMASS 2 80 0 0 0 1 1 1\nGRAVITY 0 0 -9.81\n"
        f"ELEMENTS\n{drag}TOLERANCE 1e-12\nEND\n"
    )
    found = run(tmp_path, "IND", text)
    rows = [1, 5, 10, 30]
    z = [75.1031977786, 200.990347406, 124.066374843, -930.576230172]
    speed = [62.3664710804, 7.81121014378, -35.1457854893, -56.0052482162]
    assert found["coordinate/q"][rows, 0] == pytest.approx(np.array(z), abs=1e-7)
    assert found["coordinate/u"][rows, 0] == pytest.approx(np.array(speed), abs=1e-7)


def test_a_rotor_against_quadratic_drag(tmp_path):
    """drag-quadratic, case 2: 1/(1 + k t)."""
    drag = DRAG.format("angle", -0.02, 50)
    text = f"{ROTOR}0 30 1\nDYNAMICS forward\nMASS 2 1 0 0 0 1 1 0.3\nELEMENTS\n{drag}TOLERANCE 1e-12\nEND\n"
    found = run(tmp_path, "IND", text)
    rows = [1, 5, 10, 30]
    angle = [21.9950560319, 43.0751943733, 53.0417504934, 69.2268077526]
    rate = [11.5384615385, 2.83018867924, 1.45631067961, 0.49504950495]
    assert found["coordinate/q"][rows, 0] == pytest.approx(np.array(angle), abs=1e-7)
    assert found["coordinate/u"][rows, 0] == pytest.approx(np.array(rate), abs=1e-8)


def test_a_duffing_oscillator_typed_with_variables_and_formulas(tmp_path):
    """expressions-duffing: Jacobi's cn; k3 is defined before the k that it uses."""
    text = (
        "SET mass = 0.5\nSET k3 = 20*k\nSET k = 20\nSET freq0 = sqrt(k/mass)\nSET amplitude = 0.3\n"
        f"{SLIDE}0 20 0.1\nDYNAMICS forward\nMASS 2 $mass 0 0 0 1 1 1\nELEMENTS\n"
        "  FUNCTION cubic polynomial 0 0 0 $k3\n  SPRING hold at=1.stroke stiffness=$k curve=cubic\n"
        "  START at=1.stroke value=$amplitude\n"
        "  OUTPUT power = (-k*coordinate.1 - k3*coordinate.1^3)*coordinate.1.u\n  OUTPUT natural = freq0\n"
        "TOLERANCE 1e-13\nEND\n"
    )
    found = run(tmp_path, "INE", text)
    rows = [1, 5, 10, 50, 200]
    x = [0.160120766782, 0.0275549253367, -0.292599365856, -0.147172476761, -0.170748034084]
    v = [-2.35616579385, 2.60948240937, 0.69533805402, 2.40540075346, 2.30950238866]
    power = [11.414511378, -1.45991981989, 11.0365958916, 10.1472707439, 12.4856706602]
    assert found["coordinate/q"][rows, 0] == pytest.approx(np.array(x), abs=1e-8)
    assert found["coordinate/u"][rows, 0] == pytest.approx(np.array(v), abs=1e-7)
    assert found["output/power"][rows] == pytest.approx(np.array(power), abs=1e-5)
    assert found["output/natural"][0] == pytest.approx(6.32455532034, abs=1e-11)


ROD = """    1    3
DFMB ROD
    1    0    0    0    0
    1    1    0    1    0
    0
    0
    3
       0.2
CONN
    0
MASS
    1       1.2
INER
    1     0.064     0.256     0.256
Q(k)
    1       0.0       0.0       0.0
EULT
    1       0.0       0.0       0.0       1.0
EULL
    1       0.0       0.0       0.0       1.0
Y(L)
       0.0       0.0
RC(K
    1       0.4       0.0       0.0
GRAV
    0       0.0       0.0     -9.81
TOLR
    1.000E-12    1.000E-13
END
STAR
STOP
"""


def test_the_hinge_of_a_tree_has_the_reaction_of_a_falling_rod(tmp_path):
    """reactions-rod-pendulum: elliptic functions; a hinge of a tree has no equation of its own."""
    found = run(tmp_path, "rod.DAT", ROD)
    force = [[0, 2.943], [-8.85587192665, 6.33947889365], [-5.04297092478, 28.4322640228],
             [12.6508149925, 12.2689532835]]  # fmt: skip
    angle = [1.5707963268, 1.20456969744, 0.195324381082, -0.935549326804]
    assert found["hinge/force"][:, 0, ::2] == pytest.approx(np.array(force), abs=1e-8)
    # The rod points down where it has turned by a right angle.
    assert np.pi / 2 - found["coordinate/q"][:, 0] == pytest.approx(np.array(angle), abs=1e-9)
