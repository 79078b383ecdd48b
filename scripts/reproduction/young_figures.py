"""YOUNG (1996), chapter 6: figures 6.17 to 6.28 with smooth curves, tables 6.1, 6.2 and 6.3."""

import csv
import json
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from html_page import WIDTH, Section
from runs import DECKS, PUBLISHED, run

FINE = 0.005  # s, of both mechanisms
# Table 6.1 as scanned: row, first column, cells ("" unreadable).  The scan merges the rows of the spherical
# joint (1 to 3) with those of the universal joint (4 to 6): the columns of body 3 belong to the first.
TABLE_6_1 = (
    (4, 1, "1 0 0 0 0 4.0 0 -1 0 0 -3.17 3.29 3.54 10.7"),
    (5, 1, "0 1 0 0 -4 0 0 -1 0 0 -10.7 -3.5 3.29 -3.17"),
    (6, 1, "0 0 1 4 0 0 0 0 0 -1 3.54 -10.7 3.17 3.29"),
    (1, 15, "-1 0 0 4.49 2.66 -2.66 -4.90"),
    (2, 15, "0 -1 0 4.49 2.66 2.66 4.49"),
    (3, 15, "0 0 -1 -2.66 4.50 -4.50 2.66"),
    (7, 1, "0 0 0 -13.4 0.9 -1.02 0.55 0 0 0 -0.78 0.77 1.66 -0.08"),
    (8, 1, "1 0 0 0 0 0 0"),
    (9, 1, "0 1 0 0 0 0 0"),
    (10, 1, "0 0 1 0 0 0 0"),
    (11, 1, "0 0 0 0 0 0 -2"),
    (12, 1, "0 0 0 0 0 -2 0"),
    (18, 1, "0 0 0 0 1 0 0"),
    (19, 1, "0 0 0 1 0 0 0"),
)
ROUNDED = [
    f"body.{body}.e{k}={value}"
    for body, p in ((2, (0.88, -0.29, -0.27, -0.26)), (3, (0.61, -0.36, 0.36, -0.61)))
    for k, value in enumerate(p)
]
SPOILT = {
    (5, 8): "scan: -1 stands a column too far to the left",
    (5, 9): "scan: -1 stands a column too far to the left",
    (1, 21): "scan: digits exchanged, -4.49",
    (7, 4): "scan: point displaced, -1.34",
    (7, 5): "scan: sign lost",
}
CLAIMED = (-8.97e-3, -2.74e-3, 3.43e-3)  # per cent: mean precision of B, VB, AB in table 6.3


@dataclass(frozen=True)
class Figure:
    """A figure of chapter 6: the dataset that it shows, and column and line of the printed listing."""

    number: str
    title: str
    deck: str
    path: str
    index: tuple[int, int]
    section: str
    column: int
    unit: str


FIGURES = (
    Figure("6.17", "z of point B", "IN4-BAR", "point/position", (0, 2), "point", 3, "m"),
    Figure("6.19", "z of body 3", "IN4-BAR", "body/position", (2, 2), "position", 3, "m"),
    Figure("6.21", "dz/dt of body 3", "IN4-BAR", "body/velocity", (2, 2), "velocity", 3, "m/s"),
    Figure("6.24", "x of the slider", "IN5BODY", "body/position", (3, 0), "position", 1, "m"),
    Figure("6.26", "dx/dt of the slider", "IN5BODY", "body/velocity", (3, 0), "velocity", 1, "m/s"),
    Figure(
        "6.28", "d²x/dt² of the slider", "IN5BODY", "body/acceleration", (3, 0), "acceleration", 1, "m/s²"
    ),
)


def figures(results, pictures) -> Section:
    """Sections 6.2.1 and 6.2.2."""
    section = Section("YOUNG: figures 6.17 to 6.28")
    section.text(
        """The dissertation lays these curves beside those of DADS in Haug (1989, pages 396 to 407) and calls
        them alike. Lines: flexmb with a step of 5 ms. Circles: the numbers of the printed listing. Dashes
        in 6.28: flexmb run --as-printed, with the errors of the program."""
    )
    names = sorted({figure.deck for figure in FIGURES})
    decks = [f"young/{name}.dat" for name in names]
    fine = dict(
        zip(names, run(results / "fine", *decks, options=("--set", f"time.step={FINE}")), strict=True)
    )
    printed = run(results / "printed", *decks, options=("--as-printed",))
    emulated = dict(zip(names, printed, strict=True))
    sheet, axes = plt.subplots(3, 2, figsize=(WIDTH, 7.2), layout="constrained")
    rows = []
    for figure, axis in zip(FIGURES, axes.flat, strict=True):
        rows.append(_draw(figure, axis, fine[figure.deck], emulated[figure.deck]))
    section.table(("figure", "curve", "printed points", "largest difference", "agreement"), rows)
    section.picture(
        pictures, "young_figures.png", sheet, "Figures 6.17, 6.19, 6.21, 6.24, 6.26 and 6.28 anew."
    )
    return section


def _draw(figure, axis, fine, emulated):
    k, component = figure.index
    time, values = fine["time"][:], fine[figure.path][:, k, component]
    axis.plot(time, values, lw=1.2)
    step, printed, decimals = _printed(figure)
    when = emulated["time"][:][step]
    axis.plot(when, printed, "o", mfc="none", ms=4)
    axis.set_title(f"{figure.number}: {figure.title}, {figure.unit}", fontsize=9)
    axis.set_xlabel("time, s")
    gap = np.abs(np.interp(when, time, values) - printed)
    reported = "to the printed digit" if gap.max() <= 0.51 * 10.0**-decimals else None
    if reported is None:
        as_printed = emulated[figure.path][:][step, k, component]
        axis.plot(emulated["time"][:], emulated[figure.path][:, k, component], "--", lw=0.9)
        same = np.abs(as_printed - printed).max()
        reported = (
            f"printed values are wrong: transposed index, components M for N; with these errors {same:.0e}"
        )
    return figure.number, figure.title, len(printed), f"{gap.max():.2g} {figure.unit}", reported


def _printed(figure):
    """Rows, numbers and decimals of the figure's column in the listing."""
    with open(PUBLISHED / f"young/{figure.deck}.csv", newline="") as file:
        lines = [
            line
            for line in csv.DictReader(file)
            if line["section"] == figure.section
            and int(line["index"]) == figure.index[0] + 1
            and line[f"v{figure.column}"]
        ]
    words = [line[f"v{figure.column}"] for line in lines]
    steps = np.array([int(line["step"]) for line in lines])
    return steps, np.array(words, dtype=float), len(words[0].partition(".")[2])


def jacobians(results, pictures) -> Section:
    """Tables 6.1 and 6.2."""
    section = Section("YOUNG: tables 6.1 and 6.2")
    section.text(
        """Table 6.1 is the Jacobian of the four-bar at the estimates of its deck. Each readable cell is
        compared with the Jacobian of the deck and with that of Euler parameters rounded to two decimals,
        which the print mixes."""
    )
    exact, rounded = _jacobian("IN4-BAR"), _jacobian("IN4-BAR", *ROUNDED)
    cells = [_cell(row, first + k, word, exact, rounded) for row, first, text in TABLE_6_1
             for k, word in enumerate(text.split())]  # fmt: skip
    count = Counter(cell[-1].partition(":")[0] for cell in cells)
    section.table(
        ("row", "column", "printed", "deck", "two decimals", "finding"),
        [c for c in cells if c[-1] != "equal"],
    )
    reported = ", ".join(f"{number} {finding}" for finding, number in count.most_common())
    section.text(f"{len(cells)} readable cells: {reported}.")
    section.text(
        """Table 6.2, the Jacobian of the RSSR at its estimates, is lost in the available text: here it is as
        flexmb has it, entries that are not zero."""
    )
    matrix = _jacobian("IN-RSSR")["matrix"]
    rows = [
        (row, ", ".join(f"{column}: {value:.4g}" for column, value in enumerate(line, start=1) if value))
        for row, line in enumerate(matrix, start=1)
    ]
    section.table(("row", "column: value"), rows)
    return section


def _jacobian(deck, *changes):
    """The Jacobian of `flexmb check --jacobian estimate`."""
    options = [word for change in changes for word in ("--set", change)]
    command = [sys.executable, "-m", "flexmb_cli", "check", DECKS / f"young/{deck}.dat", "--json", "-q"]
    command += ["--jacobian", "estimate", *options]
    reported = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    return json.loads(reported)["jacobian"]


def _cell(row, column, word, exact, rounded):
    """One cell of table 6.1 beside both Jacobians, and whether it is equal, cut off or spoilt by the scan."""
    values = [found["matrix"][row - 1][column - 1] for found in (exact, rounded)]
    unit, printed = 10.0 ** -len(word.partition(".")[2]), float(word)
    if any(abs(printed - value) <= 0.51 * unit for value in values):
        finding = "equal"
    elif any(int(value / unit) == round(printed / unit) for value in values):
        finding = "cut off, not rounded"
    else:
        finding = SPOILT.get((row, column), "unexplained")
    return row, column, word, f"{values[0]:.3f}", f"{values[1]:.3f}", finding


def precision(results, pictures) -> Section:
    """Table 6.3 and conclusion 3 of chapter 7."""
    section = Section("YOUNG: table 6.3, the precision of the RSSR")
    with open(PUBLISHED / "young/coelho_rssr.csv") as file:
        table = list(csv.DictReader(line for line in file if not line.startswith("#")))
    own, his = run(results, "young/IN-RSSR.dat", "young/IN-RSSR-COELHO.dat")
    rows = []
    kinds = ("position", "velocity", "acceleration")
    for end, kind, claim in zip(("B", "VB", "AB"), kinds, CLAIMED, strict=True):
        given = np.array([[float(line[f"{end}{axis}"]) for axis in "xyz"] for line in table])
        moved, met = (result[f"point/{kind}"][:, 1] for result in (own, his))
        shares = [_mean_share(values, given) for values in (moved, np.round(moved, 4), met)]
        rows.append((end, f"{claim:.2e} %", *(f"{share:.1e} %" for share in shares)))
    head = (
        "vector",
        "quoted in chapter 7",
        "deck of the dissertation",
        "its printed digits",
        "Coelho's constants",
    )
    section.table(head, rows)
    section.text(
        """Table 6.3 itself is lost; chapter 7 quotes mean precisions of position, velocity and acceleration
        of B and ascribes them to FEPS and EPSLU. Here are mean differences of the components from Coelho's,
        the largest in per cent of its peak. Differences of the quoted size come from the deck, whose
        dT is Coelho's second time stamp in place of his step, and from the four printed decimals; with his
        constants and instants they vanish. How the quoted means were formed is not said."""
    )
    return section


def _mean_share(values, given):
    """The mean difference of the component that differs most, in per cent of its peak."""
    peak = np.abs(given).max(axis=0)
    moving = peak > 0.0
    return 100.0 * float(np.abs((values - given).mean(axis=0)[moving] / peak[moving]).max())
