"""The OUT listings of Appendix B cell by cell, beside the numbers that flexmb computes.

Liang Yong, YOUNG dissertation (1996), Appendix B; what the files hold: tests/published/young/README.md.
"""

import csv
from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from flexmb_cli.solvers.kinematics.rows import Rows
from tests.solvers.kinematics.solved import PUBLISHED, rows_of_deck

ATTITUDE = slice(3, 7)  # places of p, dp and ddp in the lines of a body


@dataclass(frozen=True)
class Cell:
    """One printed number and the computed one; `column` counts from 1 as v1 … v10 do."""

    deck: str
    section: str
    index: int
    column: int
    step: int
    printed: str
    computed: float
    reading: str

    @property
    def agrees(self) -> bool:
        """Equal when rounded to the printed decimals; the sign of a zero does not count."""
        decimals = len(self.printed.partition(".")[2])
        return float(f"{self.computed:.{decimals}f}") == float(self.printed)

    def __str__(self):
        where = f"{self.deck} row {self.step} {self.section} {self.index} v{self.column}"
        return f"{where}: printed {self.printed}, computed {self.computed:.6f}"


def cells_of(deck: str) -> list[Cell]:
    """Every readable cell of a deck's listing.

    p and -p are the same attitude, and YOUNG jumps between them: p, dp and ddp of one body at one
    time are taken with the common sign that agrees with more of the printed cells.
    """
    rows, cells = rows_of_deck(deck), []
    for lines in _lines_by_owner(deck).values():
        both = [_cells(deck, lines, rows, sign) for sign in (1.0, -1.0)]
        cells += max(both, key=lambda found: sum(cell.agrees for cell in found))
    return cells


def _lines_by_owner(deck):
    lines = defaultdict(list)
    with open(PUBLISHED / f"{deck}.csv", newline="") as file:
        for line in csv.DictReader(file):
            lines[line["step"], line["section"] == "point", line["index"]].append(line)
    return lines


def _cells(deck, lines, rows, sign):
    found = []
    for line in lines:
        section, index, step = line["section"], int(line["index"]), int(line["step"])
        values = _computed(rows, section, index - 1, step)
        if section != "point":
            values[ATTITUDE] *= sign
        found += [
            Cell(deck, section, index, k, step, line[f"v{k}"], value, line["ocr"])
            for k, value in enumerate(values, start=1)
            if line[f"v{k}"]
        ]
    return found


def _computed(rows: Rows, section, item, step):
    """The numbers of one line, in the listing's order."""
    columns = {
        "position": (rows.position, rows.euler_parameters),
        "velocity": (rows.velocity, rows.euler_parameter_rates, rows.angular_velocity),
        "acceleration": (rows.acceleration, rows.euler_parameter_accelerations, rows.angular_acceleration),
        "point": (rows.point_position, rows.point_velocity, rows.point_acceleration),
    }
    return np.concatenate([column[step, item] for column in columns[section]])
