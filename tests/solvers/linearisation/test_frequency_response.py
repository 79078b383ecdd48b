"""`flexmb modes --response`: two masses in a line, against their equations of motion, and random response."""

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov

from tests.study.studies import flexmb

DECK = """3 0 2 0 0 0 0 2 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 0 0 1 0 0 0
2 0 0 0
3 0 0 0
1 2 0 0 0 0 0 0 1 0 0 1 0 0 0 1 0 0 0 1
1 3 0 0 0 -1 0 0 1 0 0 0 0 0 0 1 0 -1 0 1
1 0 0 0 0 0 0
0 1 0.1

DYNAMICS forward
MASS 2 2 0 0 0 1 1 1
MASS 3 1 0 0 0 1 1 1
FORCE 2 0 0 0 0 0 0 0 0
ELEMENTS
  SPRING base at=1.stroke stiffness=400 damping=3
  SPRING between from=2(0,0,0) to=3(0,0,0) stiffness=150 rest=1 damping=0.8
END
"""
M = np.diag([2.0, 1.0])
C = np.array([[3.8, -0.8], [-0.8, 0.8]])
K = np.array([[550.0, -150.0], [-150.0, 150.0]])


def response(folder, output, *options):
    """Frequency, Hz, and complex response to the force on mass 1."""
    (folder / "two.dat").write_text(DECK)
    flexmb("modes", "two.dat", "-q", "--response", "force 1 x", f"point of interest {output} x",
           "--bode", "two.csv", *options, cwd=folder)  # fmt: skip
    table = np.loadtxt(folder / "two.csv", delimiter=",", skiprows=1)
    assert table[:, 3] == pytest.approx(np.abs(table[:, 1] + 1j * table[:, 2]))
    return table[:, 0], table[:, 1] + 1j * table[:, 2]


@pytest.mark.parametrize(
    ("output", "mass", "power"),
    [("1 position", 0, 0), ("2 position", 1, 0), ("2 velocity", 1, 1), ("1 acceleration", 0, 2)],
)
def test_response_is_that_of_the_equations_of_motion(output, mass, power, tmp_path):
    """(K - w^2 M + i w C)^-1, the acceleration with its feedthrough 1/m = 0.5 at high frequencies."""
    frequency, value = response(tmp_path, output, "--frequencies", "0.01", "1e4")
    w = 2.0 * np.pi * frequency
    expected = [(1j * s) ** power * np.linalg.inv(K - s * s * M + 1j * s * C)[mass, 0] for s in w]
    assert value == pytest.approx(np.array(expected), rel=1e-7, abs=1e-10)
    if power == 2:
        assert value[-1] == pytest.approx(0.5, abs=1e-4)


def test_root_mean_square_is_that_of_the_lyapunov_equation(tmp_path):
    """White noise of the one-sided density 2 N^2/Hz: A P + P A' + B B' = 0, of the intensity 1."""
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    B = np.array([[0.0], [0.0], [0.5], [0.0]])
    expected = np.sqrt(solve_continuous_lyapunov(A, -B @ B.T)[1, 1])
    (tmp_path / "white.csv").write_text("Hz,N2/Hz\n0.001,2\n1000,2\n")
    (tmp_path / "two.dat").write_text(DECK)
    printed = flexmb("modes", "two.dat", "--response", "force 1 x", "point of interest 2 position x",
                     "--frequencies", "0.001", "1000", "--psd", "white.csv", "--bode", "two.svg",
                     cwd=tmp_path)  # fmt: skip
    value = float(printed.stdout.rpartition("white.csv: ")[2])
    assert value == pytest.approx(expected, rel=1e-3)  # between sampled frequencies the integrand is straight
    assert (tmp_path / "two.svg").read_bytes().startswith(b"<?xml")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--bode", "x.csv"], "belong to --response"),
        (["--response", "force 1", "point of interest 1 position x"], "no input 'force 1'"),
        (["--response", "force 1 x", "point 1 x"], "has no output"),
        (["--response", "force 1 x", "point 1 x", "--frequencies", "2", "1"], "0 < LOW < HIGH"),
        (["--response", "force 1 x", "point 1 x", "--bode", "x.txt"], "end the name with .csv"),
        (["--response", "force 1 x", "point of interest 1 position x", "--psd", "two.dat"], "needs a head"),
    ],
)
def test_wrong_calls_are_refused(options, message, tmp_path):
    (tmp_path / "two.dat").write_text(DECK)
    refused = flexmb("modes", "two.dat", *options, cwd=tmp_path, check=False)
    assert refused.returncode == 2 and message in refused.stderr
