"""YOUNG (1996): the listings of Appendix B cell by cell, and Prof. Coelho's table of Appendix C."""

import csv
from collections import Counter, defaultdict

import matplotlib.pyplot as plt
import numpy as np
from html_page import WIDTH, Section
from runs import PUBLISHED, run

from flexmb_cli.dialects.young.listing_reader import YOUNG_ERRORS

DATASETS = {
    "position": ("position", "euler_parameters"),
    "velocity": ("velocity", "euler_parameter_rates", "angular_velocity"),
    "acceleration": ("acceleration", "euler_parameter_accelerations", "angular_acceleration"),
}
ATTITUDE = slice(3, 7)  # places of p, dp and ddp: p and -p are the same attitude
ENDS = ("A", "B", "VA", "VB", "AA", "AB")


def listings(results, pictures) -> Section:
    """The eighteen listings: how many cells, how many equal, and why the others are not."""
    section = Section("YOUNG: the listings of Appendix B")
    section.text(
        """Every readable cell of the listings is compared with the computed number rounded to the same
        decimals. A cell that differs belongs to a known error of the program, whose cause was found by
        putting the error into a re-computation; the last column counts what none explains. The column
        "as printed" counts the cells that flexmb run --as-printed gives, which makes these errors: 19 cells
        of OUT1-4-3 come from an earlier program, and three of OUT2-6-1 from reals of eleven digits."""
    )
    rows, causes = [], Counter()
    paths = sorted((PUBLISHED / "young").glob("IN*.csv"))
    decks = [f"young/{path.stem}.dat" for path in paths]
    found, emulated = run(results, *decks), run(results / "printed", *decks, options=("--as-printed",))
    for path, result, emulation in zip(paths, found, emulated, strict=True):
        cells = _cells(path, result)
        wrong = [cell for cell in cells if not cell["agrees"]]
        explained = [_cause(path.stem, cell) for cell in wrong]
        causes.update((path.stem, cause) for cause in explained if cause)
        worst = max((abs(cell["printed"] - cell["computed"]) for cell in wrong), default=0.0)
        same = sum(cell["agrees"] for cell in _cells(path, emulation))
        equal = len(cells) - len(wrong)
        rows.append((path.stem, len(cells), equal, f"{worst:.3g}", same, explained.count(None)))
    totals = [sum(row[k] for row in rows) for k in (1, 2, 4, 5)]
    rows.append(("all", *totals[:2], "", *totals[2:]))
    section.table(("deck", "cells", "equal", "largest difference", "as printed", "unexplained"), rows)
    section.heading("Errors in print")
    section.table(("listing", "cells", "cause"), [(d, n, c) for (d, c), n in sorted(causes.items())])
    section.text(
        """Of 10,788 readable cells 8,642 stand in lines that the scan left undamaged; the others were put
        back in their places, or a zero, a sign or a digit was restored."""
    )
    return section


def _cells(path, result):
    lines = defaultdict(list)
    with open(path, newline="") as file:
        for line in csv.DictReader(file):
            lines[line["step"], line["section"] == "point", line["index"]].append(line)
    found = []
    for group in lines.values():
        both = [[cell for line in group for cell in _line(line, result, sign)] for sign in (1.0, -1.0)]
        found += max(both, key=lambda cells: sum(cell["agrees"] for cell in cells))
    return found


def _line(line, result, sign):
    section, step, item = line["section"], int(line["step"]), int(line["index"]) - 1
    if section == "point":
        values = np.concatenate([result[f"point/{name}"][step, item] for name in DATASETS])
    else:
        values = np.concatenate([result[f"body/{name}"][step, item] for name in DATASETS[section]])
        values[ATTITUDE] *= sign
    for column, computed in enumerate(values, start=1):
        printed = line[f"v{column}"]
        if printed:
            decimals = len(printed.partition(".")[2])
            agrees = float(f"{computed:.{decimals}f}") == float(printed)
            yield {"section": section, "index": item + 1, "column": column, "step": step,
                   "printed": float(printed), "computed": computed, "agrees": agrees}  # fmt: skip


def _cause(deck, cell):
    for error in YOUNG_ERRORS:
        here = error.deck == deck and error.section == cell["section"]
        if here and error.holds(cell["index"], cell["column"], cell["step"]):
            return error.cause
    return None


def coelho(results, pictures) -> Section:
    """Prof. Coelho's sixteen digits beside the same instants of flexmb."""
    section = Section("YOUNG: the RSSR of Appendix C")
    with open(PUBLISHED / "young/coelho_rssr.csv") as file:
        table = list(csv.DictReader(line for line in file if not line.startswith("#")))
    (result,) = run(results, "young/IN-RSSR-COELHO.dat")
    printed = {end: _vectors(table, end) for end in ENDS}
    computed = {end: _end(result, end) for end in ENDS}
    rows = []
    for end in ENDS:
        gap = np.linalg.norm(printed[end] - computed[end], axis=1).max()
        rows.append((end, f"{gap:.2e}", f"{gap / np.linalg.norm(printed[end], axis=1).max():.1e}"))
    section.text(
        """Rod ends A and B, their velocities and accelerations, at the twelve instants. His rod changes
        its length by 5e-8 m from instant to instant, which shows in B; A is free of it. The
        dissertation's own comparison found 1e-3 %, because its deck took the second instant for the
        step."""
    )
    section.table(("vector", "largest difference, m, m/s, m/s²", "relative"), rows)
    figure, axes = plt.subplots(3, 1, figsize=(WIDTH, 6.2), sharex=True, layout="constrained")
    units = ("m", "m/s", "m/s²")
    time = np.array([float(line["time"]) for line in table])
    for axis, end, unit in zip(axes, ("B", "VB", "AB"), units, strict=True):
        for k, component in enumerate("xyz"):
            (line,) = axis.plot(result["time"][:], computed[end][:, k], label=f"flexmb {component}")
            axis.plot(time, printed[end][:, k], "o", mfc="none", color=line.get_color())
        axis.set_ylabel(f"{end}, {unit}")
    axes[2].set_xlabel("time, s")
    axes[0].legend(fontsize=8, ncols=3)
    section.picture(
        pictures, "coelho.png", figure, "Rod end B of the RSSR: circles Coelho (1996), lines flexmb."
    )
    return section


def _vectors(table, end):
    return np.array([[float(line[f"{end}{axis}"]) for axis in "xyz"] for line in table])


def _end(result, end):
    kind = {"": "position", "V": "velocity", "A": "acceleration"}[end[:-1]]
    return result[f"point/{kind}"][:, "AB".index(end[-1])]
