"""Errors in print that the documentation names, counted and recomputed.

Liang Yong, YOUNG dissertation (1996), table 6.1 and Appendix B; Vlasenko and Kasper (2008), section XI.
"""

import csv
from pathlib import Path

import numpy as np
import pytest
from scipy.io import mmread

from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.outcome import RunOptions
from tests.dialects.young.published_cells import cells_of

TOP = Path(__file__).resolve().parents[3]
PUBLISHED = TOP / "tests/published/young"


def test_of_10788_printed_cells_8642_survive_the_scan_undamaged():
    """The others stand in lines that the scan moved, or of which it lost a zero, a sign or a digit."""
    whole = total = 0
    for path in PUBLISHED.glob("IN*.csv"):
        with open(path, newline="") as file:
            for line in csv.DictReader(file):
                cells = sum(bool(line[f"v{k}"]) for k in range(1, 11))
                total += cells
                whole += cells if line["ocr"] == "ok" else 0
    assert (whole, total) == (8642, 10788)


def test_what_is_wrong_in_out1_4_3_at_t_3():
    """e0 from a double root (0.06), and with it de2 (0.03), X, Z and four more cells of the point."""
    wrong = [cell for cell in cells_of("IN1-4-3") if cell.step == 3 and not cell.agrees]
    found = {
        (cell.section, cell.column): float(cell.printed) for cell in wrong if cell.section != "acceleration"
    }
    assert found == {
        ("position", 4): 0.06,
        ("velocity", 6): 0.03,
        ("point", 1): -0.87,
        ("point", 3): -1.12,
        ("point", 4): -1.17,
        ("point", 6): 0.91,
        ("point", 7): 0.95,
        ("point", 9): 1.22,
    }


ROUNDED = ("body.2.e0=0.88", "body.2.e1=-0.29", "body.2.e2=-0.27", "body.2.e3=-0.26")


@pytest.mark.parametrize(
    ("changes", "first", "fifth"),
    [((), -1.3595, -0.7950), (ROUNDED, -1.347, -0.788)],
    ids=["deck", "rounded"],
)
def test_table_6_1_has_euler_parameters_of_two_decimals(changes, first, fifth):
    """Row 7, s_i · s_j of the universal joint, of the bodies 1 and 2: printed -13.4 (for -1.34) and -0.78."""
    deck = str(TOP / "decks/young/IN4-BAR.dat")
    found = check_deck(deck, RunOptions(changes=changes), "estimate").jacobian
    row = found.matrix[6]
    assert "s_i" in found.rows[6]
    assert row[3] == pytest.approx(first, abs=5e-4) and row[10] == pytest.approx(fifth, abs=5e-4)


def test_the_inertia_of_the_pendulum_is_not_that_of_the_paper():
    """About its end m L²/3 = 8.7e-4 kg m² of 0.26 kg and 0.1 m; the printed 3.3e-3 is L²/3, of 1 kg."""
    folder = TOP / "decks/vsdf/fe"
    nodes = np.loadtxt(folder / "pendulum_nodes.txt")[:, 1:]
    arms = nodes - [0.0, 0.0, nodes[:, 2].mean()]
    turning = np.cross([0.0, 1.0, 0.0], arms).ravel()
    inertia = turning @ (mmread(folder / "pendulum_M.mtx") @ turning)
    assert inertia == pytest.approx(8.7e-4, rel=0.01)
    assert inertia / 0.26 == pytest.approx(3.3e-3, rel=0.02)
