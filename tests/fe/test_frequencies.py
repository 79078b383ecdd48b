"""Frequencies of the pendulum and the spin-up beam under many frames, from every format.

Vlasenko and Kasper (2008), section XI: nine modes from 5 to 124 Hz.  The printed digits below are those
of this project's reference computation with incompatible-mode bricks, 8 x 2 x 1, consistent mass.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.io import mmread
from scipy.linalg import eigh

from flexmb_cli.model.flexible_body import FEFile
from tests.fe.supplied import CHORD, FILES, NEAR_JOINT, OFF_LINE, PENDULUM, body, pendulum, spin_up

FREQUENCIES = {
    NEAR_JOINT: (5.26, 7.41, 24.93, 34.54, 39.86, 47.64, 60.25, 97.73, 124.32),
    OFF_LINE: (3.91, 5.24, 23.57, 30.77, 34.37, 39.92, 67.59, 90.50, 105.09),
    CHORD: (9.70, 13.98, 25.45, 32.63, 48.40, 65.03, 81.31, 95.95, 121.93),
}


@pytest.mark.parametrize("reference", FREQUENCIES, ids=["near the joint", "off the line", "chord"])
def test_the_pendulum_has_the_listed_frequencies_in_every_frame(reference):
    found = body(pendulum(reference=reference, modes=9)).frequencies
    assert np.round(found, 2).tolist() == list(FREQUENCIES[reference])


@pytest.mark.parametrize("form", ["HB", "CCX", "ABQ", "OP4"])
def test_every_format_of_full_precision_gives_the_same_frequencies_to_1e_8(form):
    wanted = body(pendulum("MM", modes=9)).frequencies
    np.testing.assert_allclose(body(pendulum(form, modes=9)).frequencies, wanted, rtol=1e-8)


def test_dmig_gives_the_frequencies_of_matrices_rounded_to_its_ten_digits():
    """Ten digits are what the field D format of a punch file leaves; they move the first mode by 2e-5."""
    rounded = [
        np.vectorize(lambda value: float(f"{value:.9e}"))(mmread(FILES / name).toarray())
        for name in PENDULUM["MM"][:2]
    ]
    held = [0, 1, 2, 3 * 12 + 1, 3 * 12 + 2, 3 * 8 + 2]
    M, K = (np.delete(np.delete(matrix, held, 0), held, 1) for matrix in rounded)
    wanted = np.sqrt(eigh(K, M, eigvals_only=True)[:9]) / math.tau
    found = body(pendulum("DMIG", modes=9)).frequencies
    np.testing.assert_allclose(found, wanted, rtol=1e-8)
    exact = body(pendulum("MM", modes=9)).frequencies
    assert 1e-6 < abs(found[0] / exact[0] - 1) < 3e-5


def sixteen_columns(value):
    """The most digits that a large field of 16 columns holds: Nastran's exponent without a letter."""
    texts = (_without_letter(value, digits) for digits in range(15, 5, -1))
    return next(text for text in texts if len(text) <= 16)


def _without_letter(value, digits):
    mantissa, exponent = f"{value:.{digits}e}".split("e")
    return f"{mantissa}{int(exponent):+d}"


def write_dmig(path, name, matrix, card):
    """Lower triangle by columns, node and direction, each by `card`."""
    lines, matrix = [f"DMIG    {name:8}       0       6       2       0"], matrix.tocsc()
    for j in range(matrix.shape[1]):
        rows = slice(matrix.indptr[j], matrix.indptr[j + 1])
        entries = zip(matrix.indices[rows], matrix.data[rows], strict=True)
        lines.extend(card(name, _dof(j), [(_dof(i), value) for i, value in entries if i >= j]))
    path.write_text("\n".join(lines) + "\n")
    return FEFile(path, "DMIG")


def _dof(row):
    return row // 3 + 1, row % 3 + 1


def large_fields(name, column, entries):
    yield f"DMIG*   {name:8}{'':8}{column[0]:16d}{column[1]:16d}"
    for (node, axis), value in entries:
        yield f"*       {node:16d}{axis:16d}{sixteen_columns(value):>16}"


def commas(name, column, entries):
    """Free fields, which may be as long as a number is."""
    yield f"DMIG,{name},{column[0]},{column[1]}"
    for (node, axis), value in entries:
        yield f",{node},{axis},{float(value)!r}"


def frequencies_by_dmig(folder, card):
    M, K = (mmread(FILES / name) for name in PENDULUM["MM"][:2])
    files = {
        "mass": write_dmig(folder / "M", "MAAX", M, card),
        "stiffness": write_dmig(folder / "K", "KAAX", K, card),
    }
    return body(replace(pendulum("MM", modes=9), **files)).frequencies


def test_dmig_with_the_most_digits_of_its_large_fields_is_off_by_4e_8(tmp_path):
    """12 digits, 13 of positive entries: two or three more than with D exponents, and no more fit."""
    found, wanted = frequencies_by_dmig(tmp_path, large_fields), body(pendulum("MM", modes=9)).frequencies
    assert 1e-9 < np.max(np.abs(found / wanted - 1.0)) < 1e-7


def test_dmig_between_commas_gives_the_same_frequencies_to_1e_8(tmp_path):
    found, wanted = frequencies_by_dmig(tmp_path, commas), body(pendulum("MM", modes=9)).frequencies
    np.testing.assert_allclose(found, wanted, rtol=1e-8)


def test_calculix_internal_freedoms_are_condensed_and_their_mass_dropped():
    """306 equations of version 2.20: 162 of nodes, 144 of incompatible modes (3 x 3 in each of 16 bricks)."""
    found = body(pendulum("CCX", modes=9))
    assert found.dropped.internal == 144
    assert found.m == pytest.approx(0.26, rel=1e-9)


def test_the_modes_dropped_are_told_with_the_first_frequency_among_them():
    found = body(pendulum(modes=8))
    assert found.dropped.modes == 162 - 6 - 8
    assert found.dropped.next_frequency == pytest.approx(124.32, abs=0.005)
    assert body(pendulum(modes=0)).dropped.modes == 0


def test_no_number_of_modes_means_all_of_them():
    assert body(pendulum(modes=0)).modes == 162 - 6
    assert body(pendulum(modes=0, mean=True)).modes == 162 - 6
    assert body(pendulum(modes=0, clamped=(1, 2, 3, 4, 5, 6))).modes == 162 - 18


def test_the_spin_up_beam_has_the_bending_frequencies_listed():
    """Out of plane 0.256, 1.61, 4.56 rad/s; in plane 3.805, 23.91, 67.26 rad/s, modes 3, 8 and 12."""
    found = body(spin_up(modes=12)).frequencies * math.tau
    assert found[[1, 3]] == pytest.approx([1.61, 4.56], abs=0.005)
    assert found[0] == pytest.approx(0.256, abs=0.001)
    assert found[2] == pytest.approx(3.805, abs=0.001)
    assert found[[7, 11]] == pytest.approx([23.91, 67.26], abs=0.005)


def test_the_first_bending_of_a_rotating_cantilever_stiffens_by_1_193_of_the_squared_spin():
    """Southwell's coefficient of the uniform cantilever, 1.193; the mesh of 30 bricks is within 1 %."""
    KG = body(spin_up(modes=12)).KG
    # Spin about z: (w~ w~)_xx = (w~ w~)_yy = -w².
    out_of_plane = -(KG[0, 0] + KG[1, 1])[0, 0]
    in_plane = -(KG[0, 0] + KG[1, 1])[2, 2]
    assert [out_of_plane, in_plane] == pytest.approx([1.193, 1.193], rel=0.01)


def test_mean_axes_give_the_frequencies_of_the_free_body():
    """The free-free eigenproblem of the whole matrices, its six zeros left out."""
    M, K = (mmread(FILES / name).toarray() for name in PENDULUM["MM"][:2])
    wanted = np.sqrt(eigh(K, M, eigvals_only=True)[6:16]) / math.tau
    found = body(pendulum(mean=True, modes=10)).frequencies
    np.testing.assert_allclose(found, wanted, rtol=1e-9)
