"""Errors of frequencies from the digits of matrix files: predicted, and found by rounding exact matrices."""

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.io import mmread

from flexmb_cli.cli.check import check
from flexmb_cli.cli.modes import modes
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.fe.formats.file_text import printed_digits
from flexmb_cli.fe.precision import rounding_errors
from tests.fe.supplied import FILES, body, nodes, pendulum
from tests.fe.trusses import files_input, truss

FRAMES = {
    "near the joint": {"reference": (11, 23, 19)},
    "clamped": {"clamped": tuple(range(11, 17))},
    "mean axes": {},
}


def matrices():
    return tuple(mmread(FILES / f"pendulum_{letter}.mtx").toarray() for letter in "MK")


def rounded(matrix, digits):
    """As a file in E format with so many significant digits has it."""
    return np.vectorize(lambda value: float(f"{value:.{digits - 1}e}"))(matrix)


def single(matrix):
    return matrix.astype(np.float32).astype(float)


def found_and_predicted(folder, frame, change, **choices):
    """Relative changes of the frequencies by `change`, a function of the stiffness, what is told of them."""
    M, K = matrices()
    given = files_input(folder, nodes().positions, M, K, modes=9, **FRAMES[frame], **choices)
    exact = flexible_body(given, cached=False)[0].frequencies
    files_input(folder, nodes().positions, M, change(K))
    poor, warnings = flexible_body(given, cached=False)
    return np.abs(poor.frequencies / exact - 1), poor.frequency_errors, [fault.message for fault in warnings]


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("digits", [6, 7, 8, 10, 12])
def test_rounded_stiffness_moves_the_frequencies_as_far_as_predicted(tmp_path, frame, digits):
    """Twice the standard deviation: hardly a mode moves farther, and most move a twentieth of it or more."""
    found, predicted, _ = found_and_predicted(tmp_path, frame, lambda K: rounded(K, digits))
    small = predicted < 0.2
    ratio = (found / predicted)[small]
    assert ratio.max() < 1.5
    assert np.sqrt(np.mean(ratio**2)) > 0.05


@pytest.mark.parametrize("frame", FRAMES)
def test_single_precision_in_double_is_recognised(tmp_path, frame):
    found, predicted, warnings = found_and_predicted(tmp_path, frame, single)
    assert 0.1 < (found / predicted).max() < 1.5
    assert any("the digits of the stiffness matrix leave mode 1" in warning for warning in warnings)


@pytest.mark.parametrize("frame", FRAMES)
def test_noise_that_no_digits_show_is_told_by_the_forces_of_a_translation(tmp_path, frame):
    """Three millionths of every entry at random, printed in full, move the first frequency by a tenth."""
    noise = 3e-6 * np.random.default_rng(0).normal(size=(162, 162))
    found, predicted, warnings = found_and_predicted(
        tmp_path, frame, lambda K: K * (1 + np.triu(noise) + np.triu(noise, 1).T)
    )
    assert 0.05 < (found / predicted).max() < 1.5
    assert any("export it with more digits" in warning for warning in warnings)


def test_the_pendulum_in_dmig_loses_what_its_ten_digits_cost():
    """The lowest frequency from DMIG's columns lies 2e-5 from that of all other formats (FORMAT.md)."""
    exact, poor = body(pendulum("MM", modes=9)), body(pendulum("DMIG", modes=9))
    found = np.abs(poor.frequencies / exact.frequencies - 1)
    assert found[0] == pytest.approx(2e-5, rel=0.5)
    assert 0.2 < found[0] / poor.frequency_errors[0] < 1.0
    assert (found < 1.5 * poor.frequency_errors).all()
    assert exact.frequency_errors.max() < 1e-10


def test_internal_freedoms_count_with_what_they_move():
    """CalculiX's fourteen digits and condensed incompatible modes: 1e-9 from the others."""
    exact, poor = body(pendulum("MM", modes=9)), body(pendulum("CCX", modes=9))
    found = np.abs(poor.frequencies / exact.frequencies - 1)
    assert (found < 1.5 * poor.frequency_errors).all()
    assert found.max() > 0.02 * poor.frequency_errors.max()


def test_numbers_of_few_digits_that_balance_are_exact(tmp_path):
    """Bars of 200 and 400 N/m along axes and diagonals: entries of 100, 200, 400 N/m, and no more digits."""
    corners, K = np.vstack([np.zeros(3), np.eye(3)]), np.zeros((12, 12))
    for i in range(4):
        for j in range(i):
            along = corners[i] - corners[j]
            bar, ends = np.concatenate([along, -along]), np.add.outer([3 * i, 3 * j], range(3)).ravel()
            K[np.ix_(ends, ends)] += 200.0 * np.outer(bar, bar)
    M = truss(3, 4)[2]
    assert rounding_errors(K).digits < 4
    given = files_input(tmp_path, corners, M, K, clamped=(11, 12, 13), modes=2)
    found, warnings = flexible_body(given, cached=False)
    assert found.frequency_errors.max() < 1e-12
    assert not [fault for fault in warnings if "digits of the" in fault.message]


@pytest.mark.parametrize("form", ["{:.17g}", "{!r}", "{:.3e}", "{:.15e}"])
@pytest.mark.parametrize("mass", [2.0, 0.108])
def test_masses_of_few_digits_that_are_exact_are_not_blamed(tmp_path, form, mass):
    """Equal masses at the nodes of the pendulum, as they are printed by C, by Python, and in fixed formats.

    The stiffness has all its digits, and nothing else is uncertain.
    """
    K = matrices()[1]
    given = files_input(
        tmp_path, nodes().positions, mass * np.eye(len(K)), K, clamped=FRAMES["clamped"]["clamped"]
    )
    rows = [f"{k} {k} {form.format(mass)}" for k in range(1, len(K) + 1)]
    head = "%%MatrixMarket matrix coordinate real symmetric"
    (tmp_path / "M.mtx").write_text("\n".join([head, f"{len(K)} {len(K)} {len(K)}", *rows]) + "\n")
    found, warnings = flexible_body(replace(given, modes=9), cached=False)
    assert found.frequency_errors.max() < 1e-8
    assert not [fault for fault in warnings if "digits of the" in fault.message]


def test_masses_rounded_to_three_digits_are_blamed_by_name(tmp_path):
    """28 different masses of a truss, of which nearly all need the third digit."""
    r, m, M, K = truss(3)
    clamped = {"clamped": (11, 12, 13)}
    exact = flexible_body(files_input(tmp_path, r, M, K, **clamped), cached=False)[0].frequencies
    coarse = np.kron(rounded(m, 3), np.eye(3))
    poor, warnings = flexible_body(files_input(tmp_path, r, coarse, K, **clamped), cached=False)
    ratio = np.abs(poor.frequencies / exact - 1) / poor.frequency_errors
    assert 0.02 < ratio.max() < 1.5
    (warning,) = [fault for fault in warnings if "digits of the" in fault.message]
    assert warning.message.startswith("the digits of the mass matrix leave mode ")


@pytest.mark.parametrize(
    "text, digits",
    [
        ("2.000000E+00 0.5000000D-3", 7),
        ("-1.08000-3-2.50000+4", 6),
        ("2.0 20. 100.0 3", 0),
        ("%version 3.14159265\n0.00250", 3),
        ("0.1080000000000000", 16),
    ],
)
def test_printed_digits_count_the_zeros_that_a_format_leaves(tmp_path, text, digits):
    (tmp_path / "file").write_text(text)
    assert printed_digits(tmp_path / "file") == digits


@pytest.mark.parametrize(
    "values, digits", [([1234.5, 0.00012345, -7.0], 5), (np.sqrt([2.0, 3.0, 5.0]), 16), ([100.0, 2e5], 1)]
)
def test_digits_are_those_that_the_longest_number_needs(values, digits):
    assert rounding_errors(np.array(values)).digits == digits


def test_modes_and_check_print_the_error_beside_the_frequency(tmp_path, monkeypatch):
    monkeypatch.setenv("FLEXMB_CACHE_DIR", str(tmp_path))
    deck = str(FILES.parent / "pendulum_dmig.vsdf")
    table = CliRunner().invoke(modes, [deck]).stdout.splitlines()
    assert table[8].split()[:4] == ["mode", "rad/s", "Hz", "error"]
    assert [float(line.split()[3]) for line in table[9:11]] == [3e-5, 2e-6]
    record = json.loads(CliRunner().invoke(modes, [deck, "--json"]).stdout)
    assert record["bodies"][0]["frequency_errors"][0] == pytest.approx(2.6e-5, rel=0.1)
    assert "Hz, precise to 3e-05\n" in CliRunner().invoke(check, [deck]).stdout


def test_numbers_below_the_normal_ones_have_digits_without_a_warning():
    """Damage left a mass of 1e-320 kg in an OP4 file: its last digit was taken for 0, and divided by."""
    with np.errstate(all="raise", under="ignore"):
        found = rounding_errors(np.array([1e-320, 2.5, 1e-310, 0.1]))
    assert np.isfinite(found.deviation).all()
