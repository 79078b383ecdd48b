"""`flexmb modes --response`: frequency response of the state space, its picture, and random response."""

from difflib import get_close_matches
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

import numpy as np

from ...results.files.replaced_file import write_whole
from ..terminal.screen import WrongCall, notify

if TYPE_CHECKING:
    from ...solvers.linearisation.frequency_response import Response

SHOWN_ROWS = 13


def response_of(space: Any, names: tuple[str, str], ends: tuple[float, float] | None) -> "Response":
    """Return the response of an output to an input of a state space, by their names.

    `ends`: of the frequencies, Hz; without them from a tenth of the slowest to ten times the fastest mode.
    """
    from ...solvers.linearisation.frequency_response import Response, frequency_response, sampled_frequencies

    number, output = (_named(what, getattr(space, f"{what}s"), name)
                      for what, name in zip(("input", "output"), names, strict=True))  # fmt: skip
    speeds = np.abs(np.linalg.eigvals(space.A)) / (2.0 * np.pi)
    moving = speeds[speeds > 1e-6 * max(1e-300, speeds.max(initial=0.0))]
    low, high = ends or (0.1 * moving.min(initial=1.0), 10.0 * moving.max(initial=1.0))
    frequency = sampled_frequencies(space, low, high)
    unit = f"{space.outputs[output].unit}/({space.inputs[number].unit})"
    value = frequency_response(space, (number, output), frequency)
    return Response(space.inputs[number].name, space.outputs[output].name, unit, frequency, value)


def _named(what: str, signals: Any, name: str) -> int:
    names = [signal.name for signal in signals]
    if name in names:
        return names.index(name)
    near = get_close_matches(name, names, 6, 0.3) or names[:6]
    message = f"--response: the deck has no {what} {name!r}; near it are {', '.join(near)} (--json lists all)"
    raise WrongCall(message, id="CLI-113")


def response_lines(response: "Response") -> list[str]:
    """Return some rows of a response as text: even in the logarithm, and where it is largest."""
    amplitude = np.abs(response.value)
    even = np.geomspace(response.frequency[0], response.frequency[-1], SHOWN_ROWS)
    rows = {int(np.argmin(np.abs(response.frequency - f))) for f in even} | {int(np.argmax(amplitude))}
    lines = [f"  {response.output} by {response.input}",
             f"    {'Hz':>13} {'amplitude':>14} {'phase, deg':>11}  unit {response.unit}"]  # fmt: skip
    for k in sorted(rows):
        lines.append(f"    {response.frequency[k]:13.6g} {amplitude[k]:14.7g} {response.phase[k]:11.3f}")
    return lines


def write_response(path: str, response: "Response") -> None:
    """Write the response as CSV, or as a picture, by the suffix of the path."""
    from ...results.figures.bode import bode_picture, response_csv

    form = PurePath(path).suffix[1:].lower()
    write_whole(path, response_csv(response) if form == "csv" else bode_picture(response, form))
    notify(f"{response.output} by {response.input} → {path}")


def random_line(response: "Response", path: str) -> str:
    """Return the root mean square of the output for the density in a CSV file: Hz, density by Hz."""
    try:
        table = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
        sound = (
            table.shape[1] == 2
            and len(table) > 1
            and np.all(table > 0.0)
            and np.all(np.diff(table[:, 0]) > 0)
        )
    except (OSError, ValueError, IndexError):
        sound = False
    if not sound:
        message = (
            f"--psd {path}: needs a head and rows of a rising frequency, Hz, and a density, both positive"
        )
        raise WrongCall(message, id="CLI-114")
    return f"    root mean square by the density of {path}: {response.random(*table.T):.7g}"
