"""Cases that one call of a kernel solves, to the byte what each gives alone; others take their own models."""

from pathlib import Path

import numpy as np
import pytest

from flexmb_cli import interface
from flexmb_cli.errors import FlexmbError
from flexmb_cli.study.solver import CaseSolver
from flexmb_cli.study.sweep import Sweep
from flexmb_cli.study.workers import solve_here

DECKS = Path(__file__).resolve().parents[2] / "decks"
TAKES = {"first": lambda x: x[0], "last": lambda x: x[-1], "max": np.max, "min": np.min, "series": np.asarray}


def mean(x):
    """That of a run of kinematics, whose first row is a block of its own."""
    return (x[1:].sum() + x[0]) / len(x)


def study_of(folder, deck, parameters, quantities, takes=TAKES):
    """A study that takes everything of `quantities`."""
    varied = "".join(f'"{name}" = {values}\n' for name, values in parameters.items())
    kept = "".join(f'{take}{k} = "{take} {name}"\n' for k, name in enumerate(quantities) for take in takes)
    path = folder / "study.toml"
    path.write_text(
        f'deck = "{DECKS / deck}"\nsampling = "together"\n[parameters]\n{varied}[results]\n{kept}'
    )
    return path


def alone(deck, parameters, case):
    """The result of a run of its own, or the failure."""
    changes = {name: values[case] for name, values in parameters.items()}
    try:
        return interface.solve(interface.read_deck(DECKS / deck, changes))
    except FlexmbError as failure:
        return failure


def check(folder, deck, parameters, quantities, takes=TAKES):
    """Compare all cases with runs of their own; return the exit codes."""
    found = interface.sweep(study_of(folder, deck, parameters, quantities, takes))
    for case, code in enumerate(found["exit_code"]):
        result = alone(deck, parameters, case)
        assert code == getattr(result, "exit_code", 0), result
        for k, name in enumerate(quantities) if code == 0 else ():
            for take, of in takes.items():
                expected = np.asarray(of(result[name]), dtype=float)
                assert found[f"result/{take}{k}"][case].tobytes() == expected.tobytes(), (case, take, name)
    return found["exit_code"].tolist()


@pytest.fixture
def solved_alone(monkeypatch):
    """The cases that took a model of their own."""
    cases, solve = [], CaseSolver.solve
    monkeypatch.setattr(CaseSolver, "solve", lambda self, case: cases.append(case) or solve(self, case))
    return cases


def test_speeds_accelerations_and_points_of_a_closed_loop(tmp_path, solved_alone):
    """Among them no rate, one too fast to be followed, and a number that no deck may have."""
    parameters = {
        "driver.1.B": [100.0, -146.6, 0, 3e-5, 1e12, 90.25, 146.6],
        "driver.1.A": [0.0, 5.0, 0.0, -2.5, 0.0, 7, -0.0],
        "point.1.x": [0.0, -0.0, 1.5, -2, 0.3, 1e55, 0.1],
    }
    quantities = ["point.1.z", "point.1.acceleration.x", "body.2.omega.x", "body.3.z"]
    assert check(tmp_path, "young/IN-RSSR.dat", parameters, quantities, TAKES | {"mean": mean}) == [
        0, 0, 0, 0, 2, 2, 0,
    ]  # fmt: skip
    assert solved_alone == [4, 5]


def test_a_screw_that_starts_turned(tmp_path, solved_alone):
    """A start more than 0.1 rad from the estimates is sought by the search, in a model of its own."""
    parameters = {"driver.1.C": [0.0, 0.05, 3.0, 40.0], "driver.1.B": [1.047, -2, 9.5, 0.1]}
    assert check(tmp_path, "young/IN2-6-1.dat", parameters, ["body.2.y", "point.1.acceleration.z"]) == [
        0,
        0,
        0,
        0,
    ]
    assert solved_alone == [2, 3]


def test_a_loop_whose_rows_take_many_steps_each(tmp_path, solved_alone):
    """At 80 rad/s the crank turns 8 rad between two rows; at 1 rad/s the loop is plain."""
    parameters = {"driver.1.B": [3.14159265, 1.0, 80.0]}
    assert check(tmp_path, "young/IN4-BAR.dat", parameters, ["body.3.velocity.z", "body.2.e0"]) == [0, 0, 0]
    assert 2 in solved_alone


@pytest.mark.parametrize(
    "deck, parameters, quantities",
    [
        ("young/IN4-BAR.dat", {"revolute.2.P_i.y": [3.7, 4.0]}, ["body.3.z"]),  # the second locks
        ("young/dynamics/IN-RSSR-MASS.dat", {"driver.1.B": [140.0, 146.6]}, ["body.3.z"]),
        ("dafms/pendulum.DAT", {"bkp.1.BKP(1)": [19.6, 30.0]}, ["body.1.z"]),
        ("vsdf/pendulum.vsdf", {"gravity.g.z": [-9.81, -19.62]}, ["point.1.z"]),
    ],
)
def test_cases_that_take_models_of_their_own(tmp_path, solved_alone, deck, parameters, quantities):
    codes = check(tmp_path, deck, parameters, quantities)
    assert solved_alone == [0, 1] and codes[0] == 0


def test_cases_fill_calls_and_blocks_as_they_come(tmp_path, monkeypatch):
    """Cases of a block that was begun go on in other calls, with the same bytes."""
    parameters = {"driver.1.B": np.linspace(90.0, 150.0, 250).tolist()}
    path = str(study_of(tmp_path, "young/IN-RSSR.dat", parameters, ["body.3.z"], {"last": None}))
    whole = Sweep.of(path, str(tmp_path / "whole"))
    begun = Sweep.of(path, str(tmp_path / "begun"))
    assert whole.solver.at_once > 3
    for block in range(0, begun.job.blocks, 2):
        with begun.job.part(block) as part:
            part.append([begun.solver.solve(begun.job.cases(block)[0])])
    for sweep in (whole, begun):
        solve_here(sweep, range(sweep.job.blocks), lambda cases: None)
    for one, other in zip(whole.results(), begun.results(), strict=True):
        assert (one.case, one.values.tobytes()) == (other.case, other.values.tobytes())
    for sweep in (whole, begun):
        sweep.lock.leave()
