"""Results of a case that are frequencies and damping ratios of the mechanism's modes."""

import re
from collections.abc import Iterable

from ..deck.record import Deck
from ..errors import AnalysisError, Fault
from ..results.quantities.quantities import Quantity
from ..run.mechanism_modes import Wish
from ..run.model import model_of
from ..run.modes import mechanism_modes
from ..run.outcome import Run
from .study import FREQUENCY, Kept

_MODE = re.compile(r"(\d+)(?:\s+at\s+(\S+)|\s+(equilibrium))?")


def modal_quantity(item: Kept, faults: list[Fault]) -> Quantity | None:
    """Return the quantity of a result: `frequency 1`, `damping 2 equilibrium` or `frequency 1 at 0.5`."""
    if _wish(item) is None:
        message = "names a mode by its number, then its state: frequency 1, damping 2 equilibrium"
        faults.append(Fault("error", message, item.place, f"result {item.name}", id="STUDY-116"))
        return None
    unit = "Hz" if item.take == FREQUENCY else "1"
    name = f"mode {item.quantity}"
    return Quantity(name, unit, f"{item.take} of {name}", "", ())


def modal_values(items: Iterable[Kept], deck: Deck, run: Run) -> list[float]:
    """Return the values of results of modes.  Raises FlexmbError."""
    modes = {}
    values = []
    for item in items:
        wish = _wish(item)
        assert wish is not None, "it has been read"
        if wish not in modes:
            modes[wish] = mechanism_modes(model_of(deck, run), wish, run).modes
        series = modes[wish].frequency if item.take == FREQUENCY else modes[wish].damping
        number = int(item.quantity.split()[0])
        if not 1 <= number <= len(series):
            message = f"mode {number}: the mechanism has {len(series)} modes that oscillate"
            raise AnalysisError(Fault("error", message, item.place, item.name, id="STUDY-117"), 0.0)
        values.append(float(series[number - 1]))
    return values


def _wish(item: Kept) -> Wish | None:
    parts = _MODE.fullmatch(item.quantity)
    if parts is None:
        return None
    try:
        return Wish(float(parts[2]) if parts[2] else None, bool(parts[3]))
    except ValueError:
        return None
