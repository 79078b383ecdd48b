"""Times at which functions of a tree jump or bend, where steps end."""

from collections.abc import Iterator

from ...errors import AnalysisError, Fault
from ...model.laws import DRIVING
from ...model.signals import TIME_SIGNAL, sampling_times
from ...model.time_functions import corners
from ...model.tree import Tree
from ...model.unit_checks import uneven_masses
from ..table_times import jump_at, jump_within_no_time, times_between


def breakpoints(tree: Tree, start: float, end: float) -> list[float]:
    """Times inside (start, end) at which a function of the tree jumps or bends."""
    elements = tree.elements
    functions = [item["function"] for law in DRIVING for item in elements.of(law)]
    functions += [item.function for item in elements.drivers]
    functions += [torque.function for torque in tree.torques]
    functions += [signal.function for signal in elements.signals if signal.kind == TIME_SIGNAL]
    times = [t for function in functions for t in corners(function)]
    return times_between([*times, *sampling_times(elements.signals, tree.time.start, end)], start, end)


def refuse_jumps(tree: Tree) -> None:
    """Raise AnalysisError where the rate of a driver jumps between two times that count as one."""
    if message := jump_within_no_time(_times_of_drivers(tree), tree.time.end):
        raise AnalysisError(Fault("error", message, id="SOLVE-061"), tree.time.start)


def why_no_step(tree: Tree, t: float) -> str:
    """Return why steps vanish at t, s."""
    return (
        jump_at(_times_of_drivers(tree), t)
        or uneven_masses([(body.name, body.mass) for body in tree.bodies])
        or "the motion or a load grows without bound there, or the tolerance is finer than round-off"
    )


def _times_of_drivers(tree: Tree) -> Iterator[list[float]]:
    yield from (sorted(corners(item.function)) for item in tree.elements.drivers)
