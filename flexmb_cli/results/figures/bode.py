"""Frequency responses as CSV, and as a picture: amplitude, phase and Nyquist curve."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .look import GRID
from .plots import figure_bytes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ...solvers.linearisation.frequency_response import Response

HEADS = "frequency [Hz],real,imaginary,amplitude,phase [deg]"


def response_csv(response: "Response") -> bytes:
    """Return the response as a table, a row for each frequency."""
    value = response.value
    columns = (response.frequency, value.real, value.imag, np.abs(value), response.phase)
    rows = (",".join(map(repr, row)) for row in zip(*(column.tolist() for column in columns), strict=True))
    return "\n".join([HEADS, *rows, ""]).encode()


def bode_picture(response: "Response", form: str) -> bytes:
    """Return amplitude and phase over the frequency, and the Nyquist curve, as a file of `form`."""

    def make() -> "Figure":
        from matplotlib.figure import Figure

        figure = Figure(figsize=(8.0, 8.0), layout="constrained")
        figure.suptitle(f"{response.output} by {response.input}")
        axes = figure.subplot_mosaic([["amplitude"], ["phase"], ["nyquist"]], height_ratios=[1, 1, 1.4])
        axes["amplitude"].loglog(response.frequency, np.abs(response.value))
        axes["amplitude"].set(ylabel=f"amplitude [{response.unit}]")
        axes["phase"].semilogx(response.frequency, response.phase)
        axes["phase"].set(xlabel="frequency [Hz]", ylabel="phase [deg]")
        axes["nyquist"].plot(response.value.real, response.value.imag)
        axes["nyquist"].set(xlabel="real part", ylabel="imaginary part", aspect="equal")
        axes["nyquist"].set_adjustable("datalim")
        for axis in axes.values():
            _grid(axis)
        return figure

    return figure_bytes(make, form, None, str)


def _grid(axis: Any) -> None:
    axis.grid(True, **GRID)
