"""Functions of time, motors and loads over time in Exudyn: its motion is that of flexmb."""

import math
import re

import numpy as np
import pytest

from flexmb_cli.interface import solve
from flexmb_cli.model.piecewise_polynomials import linear_table, spline_table
from flexmb_cli.model.time_functions import COMPOUND, PIECEWISE, SINE, SPIN_UP, MotionFunction, table_function
from flexmb_cli.results.models.exudyn_functions import FUNCTIONS, function_text
from tests.run.convert.test_points_apart import by_exudyn

ARM = """{{ A carriage on a rail along x, an arm that turns on it about y, a bob at its end. }}
4 0 0 0 0 2 0 1 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
0.3 0 0 1 0 0 0
0.6 0 0 1 0 0 0
2 3 0.3 0 0 0 0 0 0.3 1 0 0 1 0
3 4 0.3 0 0 0 0 0 0.3 1 0 0 1 0
1 2 0 0 0 0 0 0 1 0 0 1 0 0 0 1 0 0 0 1
1 0 0 0 0 0 0
0 1 0.01

DYNAMICS forward
MASS 2 2 0 0 0 0.1 0.1 0.1
MASS 3 1 0.1 0 0.02 0.02 0.03 0.02
MASS 4 0.5 0.05 0.01 0 0.01 0.01 0.01
GRAVITY 0 0 -9.81
ELEMENTS
  FUNCTION wave sine mean=0.1 amplitude=2 omega=7 phase=0.3
  FUNCTION points spline 0 0 0.2 3 0.5 -2 1 1
  FUNCTION hard polynomial 0 5 0 40
  FUNCTION drag polynomial 0 0.1 0 0.05
  FUNCTION swing sine mean=0 amplitude=0.4 omega=5
{lines}
END
"""
CASES = {
    "motors and loads": (
        "  MOTOR turn at=1.angle effort=wave\n  MOTOR haul at=3.stroke effort=points\n"
        "  FORCE push to=4(0.1,0,0.02) direction=(0,0,1) axes=4 effort=wave\n"
        "  TORQUE twist to=3(0,0,0) direction=(0,1,0) effort=points"
    ),
    "springs with functions": (
        "  SPRING joint at=2.angle stiffness=2 rest=0.2 damping=0.1 curve=hard damper=drag\n"
        "  SPRING line from=1(0,0,1) to=4(0,0,0) stiffness=20 rest=0.9 preload=3 curve=hard damper=drag\n"
        "  SPRING rail at=3.stroke stiffness=30 damper=drag curve=hard"
    ),
}


@pytest.mark.processes
@pytest.mark.parametrize("case", CASES)
def test_exudyn_moves_by_the_functions_of_the_deck(case, tmp_path):
    """Exudyn's steps are halved until the error that the script estimates is below 1e-7 m."""
    pytest.importorskip("exudyn")
    text = ARM.format(lines=CASES[case])
    (found,) = by_exudyn(tmp_path, [text])
    own = solve(tmp_path / "d0.dat")["body/position"][:, 1:]
    assert np.ptp(own[:, 2], axis=0).max() > 0.1
    assert np.abs(found - own.reshape(len(own), -1)).max() < 1e-6


@pytest.mark.parametrize(
    "function",
    [
        table_function([0.0, 0.4, 1.0, 1.5], [0.0, 2.0, -1.0, 3.0]),
        table_function([0.0, 0.4, 1.0], [0.0, 2.0, -1.0]).of_factor,
        MotionFunction(SPIN_UP, (6.0, 0.8, 0.0, 0.0)),
        MotionFunction(PIECEWISE, pieces=spline_table([0.0, 0.3, 0.7, 1.2, 2.0], [1.0, 0.0, 2.0, 1.0, 3.0])),
        MotionFunction(PIECEWISE, pieces=linear_table([0.0, 0.5, 1.0], [0.0, 1.0, -1.0])),
        MotionFunction(
            COMPOUND,
            terms=(
                (MotionFunction(SINE, (1.0, 0.5, 3.0, 0.1)), MotionFunction(SPIN_UP, (2.0, 1.0, 0.0, 0.0))),
                (MotionFunction(1, (0.1, 0.2, 0.3, 0.4)),),
            ),
        ),
    ],
)
def test_expressions_have_the_values_of_their_functions(function):
    scope = {"math": math, "bisect_right": __import__("bisect").bisect_right}
    exec(re.sub(r"^'''|'''$", "", FUNCTIONS), scope)
    written = eval(function_text(function), scope)
    for t in (-0.5, 0.0, 0.1, 0.39, 0.4, 0.75, 1.0, 1.3, 2.5):
        assert written(t) == pytest.approx(function.at(t)[0], rel=1e-12, abs=1e-12)
