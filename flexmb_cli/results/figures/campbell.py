"""Modes over a number of a deck: a table, the Campbell diagram and the root locus."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .look import GRID
from .plots import figure_bytes, shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ...solvers.linearisation.loci import ModeLoci

LEAST_SHOWN = 1e-3  # of the largest eigenvalue: half the width of the root locus at least


def axis_label(loci: "ModeLoci") -> str:
    """Return the name of the number, with its unit if it has one."""
    return f"{loci.name} [{loci.unit}]" if loci.unit.strip("-") else loci.name


def loci_csv(loci: "ModeLoci") -> bytes:
    """Return a row for each value: the value, then frequency, damping ratio and eigenvalue of each mode."""
    parts = ("frequency [Hz]", "damping", "real [1/s]", "imaginary [1/s]")
    heads = [f"mode {k + 1} {part}" for k in range(loci.eigenvalues.shape[1]) for part in parts]
    columns = (loci.frequency, loci.damping, loci.eigenvalues.real, loci.eigenvalues.imag)
    table = np.stack(columns, axis=2).reshape(len(loci.values), -1)
    rows = [
        ",".join(map(repr, (value, *row)))
        for value, row in zip(loci.values.tolist(), table.tolist(), strict=True)
    ]
    return "\n".join([",".join([axis_label(loci), *heads]), *rows, ""]).encode()


def loci_picture(loci: "ModeLoci", orders: Sequence[float], form: str) -> bytes:
    """Return frequencies over the number, with lines of `orders` of a speed, and the root locus."""

    def make() -> "Figure":
        from matplotlib.figure import Figure

        figure = Figure(figsize=(8.0, 8.0), layout="constrained")
        campbell, locus = figure.subplots(2, height_ratios=[1.4, 1])
        campbell.plot(loci.values, loci.frequency, ".-", markersize=3)
        limits = campbell.get_ylim()
        for order in orders:
            line = order * loci.values / (2.0 * np.pi)
            campbell.plot(loci.values, line, "--", color="grey", label=f"{order:g} per turn")
        campbell.set(ylim=(0.0, limits[1]), xlabel=shown(axis_label(loci), None), ylabel="frequency [Hz]")
        if orders:
            campbell.legend(fontsize="small")
        _draw_locus(locus, loci)
        for axis in (campbell, locus):
            axis.grid(True, **GRID)
        return figure

    return figure_bytes(make, form, None, str)


def _draw_locus(axis: "Axes", loci: "ModeLoci") -> None:
    """Draw the eigenvalues above the real axis, the first of each mode as a cross."""
    for k, curve in enumerate(loci.eigenvalues.T):
        [line] = axis.plot(curve.real, curve.imag, ".-", markersize=3, label=f"mode {k + 1}")
        first = np.flatnonzero(np.isfinite(curve))[0]
        axis.plot(curve.real[first], curve.imag[first], "x", color=line.get_color())
    axis.set(xlabel="real part [1/s]", ylabel="imaginary part [1/s]")
    sizes = np.abs(loci.eigenvalues[np.isfinite(loci.eigenvalues)])
    widest = LEAST_SHOWN * sizes.max(initial=1.0)
    low, high = axis.get_xlim()
    axis.set_xlim(min(low, -widest), max(high, widest))
    if loci.eigenvalues.size:
        axis.legend(fontsize="small")
