"""`flexmb fit`: published and closed-form cases, constraints, lock-ups, kills, and faults of studies."""

import json
import signal
import subprocess
import time

import h5py
import numpy as np
import pytest
from scipy.optimize import curve_fit, least_squares

from flexmb_cli import interface
from flexmb_cli.deck.record import DeckText
from flexmb_cli.errors import AnalysisError, DeckError
from flexmb_cli.study.fit_file import read_fit
from tests.study.studies import FLEXMB, RSSR, flexmb

DECKS = RSSR.parents[1]
PATH, SPRING = DECKS / "young/dynamics/IN-PATH.dat", DECKS / "young/dynamics/IN-SPRING.dat"
MASS, X0 = 1.3, 0.2


def motion(t, k, c):
    """Position of a mass on a spring and a damper, released at rest from X0: closed form."""
    decay = 0.5 * c / MASS
    w = np.sqrt(k / MASS - decay**2)
    return X0 * np.exp(-decay * t) * (np.cos(w * t) + decay / w * np.sin(w * t))


def spring(**more):
    parameters = {
        "stiffness": {"from": 1, "to": 200, "start": 20},
        "damping": {"from": 0, "to": 10, "start": 0.1},
    }
    return {"deck": str(SPRING), "parameters": parameters, **more}


def test_stiffness_and_damping_come_back_from_an_exact_column():
    """k = 42 and c = 0.9, the numbers of the closed form that made the column."""
    t = np.linspace(0.0, 2.0, 21)
    targets = {"x": {"quantity": "body.2.x", "times": t, "values": motion(t, 42.0, 0.9)}}
    end = interface.fit(spring(targets=targets))
    assert end["parameters"] == pytest.approx({"stiffness": 42.0, "damping": 0.9}, abs=1e-6)
    assert 2.0 * end["cost"] < 1e-16
    assert end["converged"] and len(end["history"]) < 20


def test_intervals_are_those_of_a_fit_of_the_closed_form():
    """SciPy's curve_fit of the closed form to the same noisy column, with the 95 % factor of Student's t."""
    measured = np.loadtxt(DECKS / "studies/spring.csv", delimiter=",", skiprows=1)
    expected, covariance = curve_fit(motion, *measured.T, p0=[40.0, 1.0], xtol=1e-14, ftol=1e-14)
    end = interface.fit(DECKS / "studies/spring.toml")
    errors = np.sqrt(np.diag(covariance))
    for number, value, error in zip(end["numbers"], expected, errors, strict=True):
        assert number["value"] == pytest.approx(value, rel=1e-6)
        assert number["standard_error"] == pytest.approx(error, rel=1e-4)
        assert number["high"] - number["value"] == pytest.approx(2.0244 * error, rel=1e-3)  # t, 38 degrees


FIVE = np.array([3 + 3j, 2.759 + 3.363j, 2.372 + 3.663j, 1.890 + 3.862j, 1.355 + 3.943j])


def coupler_points(crank, r1, r2, r3, r4, cx, cy):
    """Points of a four-bar's coupler (m,), complex, by its loop-closure equation; pivots at 0 and r1."""
    a = r2 * np.exp(1j * crank)
    across = r1 - a
    cosine = (r3**2 + abs(across) ** 2 - r4**2) / (2.0 * r3 * abs(across))
    return a + complex(cx, cy) * np.exp(1j * (np.angle(across) + np.arccos(cosine)))


def test_five_points_with_timing_are_met_as_well_as_they_can_be():
    """Case 2 of Cabrera et al. (2002), against SciPy's least squares of the loop-closure equation."""

    def residuals(lengths):
        gap = coupler_points(np.arange(2, 7) * np.pi / 12.0, *lengths) - FIVE
        return np.concatenate([gap.real, gap.imag])

    start = [6.0, 2.0, 6.0, 6.0, 2.0, 2.0]
    best = least_squares(residuals, start, x_scale="jac", ftol=1e-14, xtol=1e-14, gtol=1e-14, max_nfev=2000)
    end = interface.fit(DECKS / "studies/path.toml")
    assert 2.0 * end["cost"] < 1e-6
    assert end["cost"] == pytest.approx(best.cost, rel=1e-5)
    lengths = [end["parameters"][name] for name in ("r1", "r2", "r3", "r4", "cx", "cy")]
    assert 0.5 * np.sum(residuals(lengths) ** 2) == pytest.approx(end["cost"], rel=1e-5)


def test_a_function_generator_is_that_of_freudensteins_equation():
    """y = x^1.5 at three Chebyshev points: the solution of three linear equations, and its largest error."""
    x = 2.5 + 1.5 * np.cos(np.radians([150.0, 90.0, 30.0]))

    def angle(x):
        return np.radians(90.0 + 90.0 * (x**1.5 - 1.0) / 7.0)

    parameters = {
        "r1": 1, "r2": {"from": -5, "to": -0.5, "start": -1.5}, "r3": {"from": 0.5, "to": 5, "start": 3},
        "r4": {"from": -5, "to": -0.5, "start": -2}, "start": "pi/6", "rate": "pi/6", "end": 3, "step": 0.05,
        "branch": -1,
    }  # fmt: skip
    targets = {"angle": {"quantity": "2*atan2(body.3.e3, body.3.e0)", "times": x - 1.0, "values": angle(x)}}
    end = interface.fit({"deck": str(PATH), "parameters": parameters, "targets": targets})
    a, b, c = -1.69996497922, 2.81022580932, -2.22380010707
    assert [end["parameters"][name] for name in ("r2", "r3", "r4")] == pytest.approx([a, b, c], abs=1e-8)
    result = interface.solve(interface.read_deck(PATH, end["parameters"]))
    rocker = 2.0 * np.arctan2(result["body.3.e3"], result["body.3.e0"])
    assert np.abs(rocker - angle(result.time + 1.0)).max() == pytest.approx(0.0145120048761, abs=1e-6)


@pytest.mark.parametrize("method", ["slsqp", "trust-constr", "differential-evolution"])
def test_the_softest_spring_of_a_frequency(method):
    """The damped frequency is f: k = m (2 pi f)^2 + c^2/(4 m), with c = 0.5 by a formula of k's start."""
    study = {
        "deck": str(SPRING), "method": method, "seed": 1, "population": 8,
        "iterations": 12 if method == "differential-evolution" else 200,
        "parameters": {"stiffness": {"from": 1, "to": 2000, "start": 900, "scale": "log"},
                       "half": 0.25, "damping": "2*half"},
        "results": {"f": "frequency 1"},
        "objective": "stiffness",
        "constraints": ["f >= 2"],
    }  # fmt: skip
    end = interface.fit(study)
    expected = MASS * (4.0 * np.pi) ** 2 + 0.25 / (4.0 * MASS)
    # Interior points end a little inside: the barrier of trust-constr.
    close = 1e-5 if method == "trust-constr" else 1e-6
    assert end["parameters"]["stiffness"] == pytest.approx(expected, rel=close)
    assert end["results"]["f"] == pytest.approx(2.0, rel=close)


def test_a_frequency_and_an_equality_are_met():
    """Frequency and damping ratio fix k and c: w0 = 2 pi f / sqrt(1 - z^2), k = m w0^2, c = 2 z m w0."""
    study = spring(
        results={"f": "frequency 1", "z": "damping 1"},
        targets={"f": {"result": "f", "value": 1.5, "weight": 10.0}, "z": {"result": "z", "value": 0.1}},
    )
    w0 = 3.0 * np.pi / np.sqrt(0.99)
    expected = [MASS * w0**2, 0.2 * MASS * w0]
    end = interface.fit(study)
    assert [end["parameters"][name] for name in ("stiffness", "damping")] == pytest.approx(expected, rel=1e-6)
    tied = interface.fit(study | {"constraints": ["stiffness == 100*damping"], "method": "slsqp"})
    assert tied["parameters"]["stiffness"] == pytest.approx(100.0 * tied["parameters"]["damping"], rel=1e-6)
    assert tied["cost"] > 1e-4 and tied["violation"] < 1e-6


LOCKING = {
    "deck": str(PATH), "restarts": 3, "seed": 2, "iterations": 40,
    "parameters": {"r1": 8, "r2": 2, "r3": {"from": 1, "to": 20}, "r4": {"from": 1, "to": 20}},
    "results": {"top": "highest point.1.y"},
    "targets": {"path": {"quantity": ["point.1.x", "point.1.y"], "points": []}},
}  # fmt: skip


def test_variants_that_lock_or_cannot_be_assembled_are_no_errors(tmp_path):
    """A path of r3 = 6, r4 = 7, without times: most of the range locks or cannot be assembled."""
    path = interface.solve(interface.read_deck(PATH))
    points = np.column_stack([path["point.1.x"], path["point.1.y"]])[3:50:6]
    study = LOCKING | {"targets": {"path": LOCKING["targets"]["path"] | {"points": points}}}
    (tmp_path / "study.toml").write_text(_toml(study))
    flexmb("fit", "study.toml", "-q", cwd=tmp_path)
    with h5py.File(tmp_path / "study.h5") as table:
        code, cost = table["exit_code"][:], table["result/cost"][:]
        value, curve = table["fit/value"][:], table["fit/target/path/curve"][:]
        assert list(table["fit/number"].asstr()[:]) == ["r3", "r4"]
    assert value == pytest.approx([6.0, 7.0], rel=1e-6)
    assert 0 < np.count_nonzero(code) < len(code) and np.all(np.isnan(cost[code != 0]))
    assert curve[:, 0] == pytest.approx(path["point.1.x"], abs=1e-5)


def _toml(study):
    from flexmb_cli.deck.toml_table import toml_text

    return toml_text(study)


def test_nothing_that_can_be_solved_is_reported_with_the_first_reason():
    parameters = LOCKING["parameters"] | {"r2": 60}
    targets = {"path": {"quantity": ["point.1.x", "point.1.y"], "points": [[1.0, 2.0]]}}
    with pytest.raises((AnalysisError, DeckError), match=r"none of|nan"):
        interface.fit(LOCKING | {"parameters": parameters, "targets": targets})


def test_a_kill_loses_running_cases_only_and_the_numbers_stay(tmp_path):
    study = DECKS / "studies/path.toml"
    flexmb("fit", study, "-o", "whole.h5", "-q", cwd=tmp_path)
    part = tmp_path / "torn.h5.parts/block-00000000.part"
    process = subprocess.Popen([*FLEXMB, "fit", str(study), "-o", "torn.h5"], cwd=tmp_path)
    while not part.exists() or part.stat().st_size < 20_000:
        assert process.poll() is None, "it ends before it is killed"
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    part.write_bytes(part.read_bytes()[:-7])  # as if the last record were half written
    again = flexmb("fit", study, "-o", "torn.h5", cwd=tmp_path)
    assert "continuing a stopped fit" in again.stderr
    assert (tmp_path / "torn.h5").read_bytes() == (tmp_path / "whole.h5").read_bytes()
    assert not part.parent.exists()


def test_processes_find_the_same_numbers(tmp_path):
    for jobs in ("1", "2"):
        flexmb("fit", DECKS / "studies/spring.toml", "-o", f"{jobs}.h5", "-j", jobs, "-q", cwd=tmp_path)
    assert (tmp_path / "1.h5").read_bytes() == (tmp_path / "2.h5").read_bytes()


def test_the_command_prints_numbers_and_a_record(tmp_path):
    study = DECKS / "studies/spring.toml"
    printed = flexmb("fit", study, cwd=tmp_path).stdout.splitlines()
    assert printed[0].startswith("stiffness = 41.9774") and " ± 0.042" in printed[0]
    record = json.loads(flexmb("fit", study, "--json", cwd=tmp_path).stdout)
    assert record["status"] == "complete" and record["fit"]["converged"]
    assert printed[-1].startswith(f"--set stiffness={record['fit']['parameters']['stiffness']!r}")
    (tmp_path / "short.toml").write_text(study.read_text().replace("../", f"{DECKS}/")
                                         .replace("spring.csv", f"{DECKS}/studies/spring.csv")
                                         .replace("deck =", "iterations = 2\ndeck ="))  # fmt: skip
    short = flexmb("fit", "short.toml", cwd=tmp_path, check=False)
    assert short.returncode == 1 and "has not converged" in short.stderr


ROLLING = """deck = "{deck}"
[parameters]
"time.end" = 0.1
"mass.3.m" = {{ from = 1, to = 2{start} }}
[results]
x = "last body.3.x"
"""


@pytest.mark.parametrize("command", ["fit", "sweep"])
def test_warnings_about_the_deck_are_printed_once(command, tmp_path):
    """The estimates of the deck lie far from the mechanism, in every variant."""
    start, more = ", start = 1.5", "[targets]\nx = { result = 'x', value = 0.2 }\n"
    if command == "sweep":
        start, more = ", count = 3", ""
    text = ROLLING.format(deck=DECKS / "young/dynamics/IN-ROLL.dat", start=start)
    (tmp_path / "study.toml").write_text(f"{'iterations = 3' if more else ''}\n{text}{more}")
    ended = flexmb(command, "study.toml", cwd=tmp_path, check=False)
    assert ended.stderr.count("IN-ROLL.dat:8:1: warning: at the body estimates more than a tenth") == 1


def test_derivatives_are_those_of_differences_of_variants(tmp_path):
    """Targets at points, by formulas and of a peak: differences of eighth order of their residuals."""
    study = LOCKING | {
        "restarts": 0, "iterations": 1,
        "parameters": {"r1": 8, "r2": 2, "share": {"from": 0.5, "to": 2, "start": 1.1, "scale": "log"},
                       "r3": "6*share", "r4": {"from": 5, "to": 20, "start": 7.5}},
        "targets": {
            "path": {"quantity": ["point.1.x", "point.1.y"], "points": [[1.0, 4.0], [2.0, 4.5]]},
            "angle": {"quantity": "2*atan2(body.3.e3, body.3.e0)", "formula": "1 + 0.1*time", "to": 0.5},
            "peak": {"result": "top", "value": 4.0, "weight": 2.0},
        },
    }  # fmt: skip
    (tmp_path / "study.toml").write_text(_toml(study))
    run = interface.open_fit(tmp_path / "study.toml", str(tmp_path / "parts"))
    run.find()
    place = np.array([0.55, 0.17])
    expected = np.zeros((0, 2))
    for weight, k in ((4 / 5, 1), (-1 / 5, 2), (4 / 105, 3), (-1 / 280, 4)):
        sides = [run.evaluate(place + sign * k * 1e-3 * np.eye(2)) for sign in (1, -1)]
        upper, lower = (np.array([each.residuals for each in side]).T for side in sides)
        part = weight * (upper - lower) / 1e-3
        expected = part if not expected.size else expected + part
    assert run.jacobian(place) == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())
    run.end()


BASE = """deck = "IN-SPRING.dat"
{top}
[parameters]
stiffness = {{ from = 1, to = 200, start = 20 }}
{parameters}
[targets]
{targets}
"""
TARGET = 'x = { quantity = "body.2.x", times = [0, 1], values = [1, 2] }'


@pytest.mark.parametrize(
    ("changes", "identifier"),
    [
        ({"top": 'objective = "stiffness"'}, "STUDY-118"),
        ({"top": 'objective = "body"', "targets": ""}, "STUDY-123"),
        ({"top": 'constraints = ["stiffness < 3"]'}, "STUDY-124"),
        ({"top": 'constraints = ["stiffness <= damping"]'}, "STUDY-123"),
        ({"top": 'constraints = ["stiffness <= 3"]\nmethod = "least-squares"'}, "STUDY-120"),
        ({"parameters": "damping = [1, 2]"}, "STUDY-121"),
        ({"parameters": "damping = { from = 0, to = 1, start = 2 }"}, "STUDY-122"),
        ({"parameters": "damping = { value = 1, tolerance = 0.1 }"}, "STUDY-141"),
        ({"parameters": 'damping = "2*mass"'}, "STUDY-112"),
        ({"parameters": 'damping = "2*mass"\nmass = "damping"'}, "STUDY-113"),
        ({"parameters": 'damping = "2*"'}, "STUDY-114"),
        ({"targets": "x = 3"}, "STUDY-125"),
        ({"targets": 'x = { quantity = "body.2.x", weight = 0, values = [1] }'}, "STUDY-126"),
        ({"targets": 'x = { result = "f", value = 1 }'}, "STUDY-127"),
        ({"targets": "x = { times = [0] }"}, "STUDY-128"),
        ({"targets": 'x = { quantity = "body.2.x", formula = "2*x" }'}, "STUDY-129"),
        ({"targets": 'x = { quantity = "body.2.x", file = "none.csv", column = "x" }'}, "STUDY-130"),
        ({"targets": 'x = { quantity = "body.2.x", points = [[1, 2]], times = [0] }'}, "STUDY-131"),
        ({"targets": 'x = { quantity = "body.2.x", values = [1, 2], times = [0] }'}, "STUDY-132"),
        ({"targets": 'x = { quantity = "body.2.x", values = [1, 2] }'}, "STUDY-133"),
    ],
)  # fmt: skip
def test_what_is_wrong_has_a_place(changes, identifier, tmp_path):
    text = BASE.format(**{"top": "", "parameters": "", "targets": TARGET} | changes)
    with pytest.raises(DeckError) as caught:
        read_fit(DeckText("fit.toml", text, ""), str(tmp_path))
    faults = {fault.id: fault for fault in caught.value.faults}
    assert identifier in faults and faults[identifier].place


def test_a_fit_without_an_unknown_number_is_refused(tmp_path):
    text = BASE.format(top="", parameters="", targets=TARGET).replace(
        "{ from = 1, to = 200, start = 20 }", "3"
    )
    with pytest.raises(DeckError) as caught:
        read_fit(DeckText("fit.toml", text, ""), str(tmp_path))
    assert [fault.id for fault in caught.value.faults] == ["STUDY-119"]
