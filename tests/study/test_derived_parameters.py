"""Formulas, numbers for all cases, groups, windows of time and extremes between rows, in studies."""

import numpy as np
import pytest

from flexmb_cli import interface
from tests.study.studies import RSSR

DECKS = RSSR.parents[1]
PATH, SPRING = DECKS / "young/dynamics/IN-PATH.dat", DECKS / "young/dynamics/IN-SPRING.dat"


def test_a_grid_of_groups_formulas_and_numbers():
    """r2 and cx go together, cy varies beside them; r1 follows r2 through a number that the deck lacks."""
    parameters = {"factor": 4, "r1": "factor*r2", "r2": [1.0, 1.5], "cx": [2.0, 3.0], "cy": [0.0, 1.0, 2.0],
                  "step": 0.25}  # fmt: skip
    table = interface.sweep(
        {"deck": str(PATH), "together": [["r2", "cx"]], "parameters": parameters,
         "results": {"y": "first body.2.y"}}
    )  # fmt: skip
    assert table["parameter/r2"].tolist() == [1.0] * 3 + [1.5] * 3
    assert table["parameter/cx"].tolist() == [2.0] * 3 + [3.0] * 3
    assert table["parameter/cy"].tolist() == [0.0, 1.0, 2.0] * 2
    assert table["parameter/r1"].tolist() == [4.0] * 3 + [6.0] * 3
    assert set(table["parameter/factor"]) == {4.0} and set(table["rows"]) == {5}


def test_extremes_and_windows_are_those_of_the_continuous_motion():
    """The pin of the crank: y = r2 sin(2 pi t + s), whose extremes lie between the rows."""
    parameters = {"start": 0.3, "r2": [1.0, 2.0], "step": 0.05}
    results = {
        "row": "max body.2.y", "top": "highest body.2.y", "bottom": "lowest body.2.y from 0.26 to 0.41",
        "mean": "mean body.2.y from 0.2 to 0.301", "last": "last body.2.y to 0.5",
    }  # fmt: skip
    table = interface.sweep({"deck": str(PATH), "parameters": parameters, "results": results})
    r2 = table["parameter/r2"]

    def sine(t):
        return np.sin(2.0 * np.pi * np.asarray(t) + 0.3)

    assert np.all(table["result/row"] < r2 * 0.9999)
    assert table["result/top"] == pytest.approx(r2, rel=1e-6)
    assert table["result/bottom"] == pytest.approx(r2 * sine(0.41), abs=1e-5)
    assert table["result/mean"] == pytest.approx(r2 * sine([0.2, 0.25, 0.3]).mean(), rel=1e-9)
    assert table["result/last"] == pytest.approx(r2 * sine(0.5), rel=1e-9)


def test_frequency_and_damping_of_a_mode():
    """Closed form of a mass on a spring: w0 = sqrt(k/m), z = c/(2 m w0), f = w0 sqrt(1 - z^2)/(2 pi)."""
    parameters = {"stiffness": [20.0, 80.0], "damping": 0.6}
    results = {"f": "frequency 1", "z": "damping 1 equilibrium"}
    table = interface.sweep({"deck": str(SPRING), "parameters": parameters, "results": results})
    w0 = np.sqrt(table["parameter/stiffness"] / 1.3)
    z = 0.6 / (2.6 * w0)
    assert table["result/z"] == pytest.approx(z, rel=1e-7)
    assert table["result/f"] == pytest.approx(w0 * np.sqrt(1.0 - z * z) / (2.0 * np.pi), rel=1e-7)


def test_a_formula_without_a_value_fails_its_case_alone():
    parameters = {"damping": [0.5, -1.0], "stiffness": "20*log(damping)^2 + 1"}
    table = interface.sweep(
        {"deck": str(SPRING), "parameters": parameters, "results": {"x": "last body.2.x"}}
    )
    assert table["exit_code"].tolist() == [0, 2]
    assert np.isfinite(table["result/x"]).tolist() == [True, False]
