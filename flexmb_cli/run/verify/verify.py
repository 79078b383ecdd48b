"""Two formulations of a deck, and how far their motions lie apart.

DAFMS: Kane's equations and absolute coordinates.  YOUNG: Euler parameters and natural coordinates.  VSDF: two
floating frames.
"""

import numpy as np

from ...errors import ANALYSIS_FAILED
from ...model.tree import ELASTIC, ROTATION, TRANSLATION, Tree
from ...quick_dataclass import dataclass, replace
from ...results.texts.echo import echo
from ..absolute_march import AbsoluteMarch
from ..dafms_tree import tree_of
from ..deck import open_deck
from ..exit_status import ending_recorded
from ..outcome import Listener, Outcome, RunOptions, Stop
from . import frames, young
from .difference import Difference, largest_difference

# Both march more closely than they are compared; deflections are small against a metre.
RTOL, ATOL = 1e-11, 1e-13

ENERGIES = ("kinetic", "potential", "strain", "total")
POINTS = {"position": "m", "velocity": "m/s"}


@dataclass
class Verification:
    """What a comparison found; `tolerance` is what a relative difference may reach.

    `formulations` names what was compared.
    """

    outcome: Outcome
    tolerance: float
    differences: tuple[Difference, ...] = ()
    formulations: str = ""

    @property
    def largest(self) -> Difference | None:
        """The largest relative difference; None before anything was compared."""
        # What is no number is further apart than any.
        sizes = np.nan_to_num([found.relative for found in self.differences], nan=np.inf)
        return self.differences[int(np.argmax(sizes))] if self.differences else None

    def as_dict(self) -> dict:
        """The record that `--json` prints."""
        rows = [
            {
                "quantity": found.name,
                "unit": found.unit,
                "difference": found.difference,
                "scale": found.scale,
                "relative": found.relative,
                "time": found.time,
            }
            for found in self.differences
        ]
        agree = bool(rows) and self.outcome.exit_code == 0
        record = {"formulations": self.formulations, "tolerance": self.tolerance, "agree": agree}
        return self.outcome.as_dict() | record | {"differences": rows}


def verify_deck(
    path: str, options: RunOptions, tolerance: float, listener: Listener | None = None
) -> Verification:
    """Run the deck at `path` by two formulations, and compare the motions.

    The outcome's exit code is 1 when they lie further apart than `tolerance`.  Never raises for what a
    deck can do.
    """
    found = Verification(Outcome(path), tolerance)
    with ending_recorded(found.outcome, options), Stop.released():
        deck = open_deck(path, options, found.outcome)
        if options.echo:
            found.outcome.echo = echo(deck)
        found.formulations, compare = COMPARED[deck.dialect]
        found.differences = compare(deck, options, found.outcome, listener or Listener())
        if not found.largest.relative <= tolerance:
            found.outcome.exit_code = ANALYSIS_FAILED
    return found


def _tree_differences(deck, options, outcome, listener):
    tree = tree_of(deck, options, outcome)
    given = {"method": "dop853", "rtol": RTOL, "atol": ATOL} | options.integration
    tree = replace(tree, integration=replace(tree.integration, **given))
    found = differences(tree, *_motions(tree, listener))
    outcome.rows = tree.time.rows
    return found


def _motions(tree, listener):
    """Values of both formulations, whole runs by the paths of their datasets."""
    from ...results.hdf5.tree import tree_values
    from ...solvers.compilation import tell_of_compiling
    from ...solvers.tree.analysis import TreeAnalysis
    from ...solvers.tree.points import point_motion

    absolute = AbsoluteMarch(tree, listener)
    listener.begin(2 * tree.time.rows)
    tell_of_compiling(listener, "integrators.tree_dop853.call")
    blocks = [
        tree_values(tree, rows, point_motion(tree, rows))
        for rows in _heard(TreeAnalysis(tree).rows(), listener)
    ]
    return _joined(blocks), _joined(list(_heard(absolute.blocks(), listener)))


def _heard(blocks, listener):
    for block in blocks:
        yield block
        Stop.heed()
        listener.advance(len(block["time"] if isinstance(block, dict) else block.time))


def _joined(blocks):
    return {path: np.concatenate([block[path] for block in blocks]) for path in blocks[0]}


def differences(tree: Tree, kane: dict, absolute: dict) -> tuple[Difference, ...]:
    """Return what two motions of a tree differ in, quantity by quantity."""
    found = [*_coordinates(tree, kane, absolute)]
    for kind, unit in POINTS.items():
        for place in ("body", "point"):
            path = f"{place}/{kind}"
            found.append(_largest(f"{place} {kind}", unit, kane, kane[path], absolute[path]))
    attitudes = kane["body/euler_parameters"], absolute["body/euler_parameters"]
    # p and -p are one attitude.
    signs = np.where(np.sum(attitudes[0] * attitudes[1], axis=-1, keepdims=True) < 0, -1.0, 1.0)
    found.append(_largest("body attitude", "1", kane, attitudes[0], signs * attitudes[1]))
    path = "body/angular_velocity"
    found.append(_largest("body angular velocity", "rad/s", kane, kane[path], absolute[path]))
    moved = max(np.max(np.abs(kane[f"energy/{name}"])) for name in ("kinetic", "strain"))
    for name in ENERGIES:
        pair = kane[f"energy/{name}"], absolute[f"energy/{name}"]
        found.append(_largest(f"{name} energy", "J", kane, *pair, scale=moved))
    return tuple(found)


def _coordinates(tree, kane, absolute):
    """Coordinates and speeds by kind; integrals of angular velocities are no coordinates of a position."""
    kinds = np.array([c.motion for c in tree.coordinates])
    ball = [c.motion == ROTATION and len(tree.hinges[c.body].rotations) == 3 for c in tree.coordinates]
    for kind, unit in ((ROTATION, "rad"), (TRANSLATION, "m"), (ELASTIC, "m")):
        for path, name, per in (("coordinate/q", "coordinates", ""), ("coordinate/u", "speeds", "/s")):
            own = kinds == kind
            if path == "coordinate/q":
                own &= ~np.array(ball, bool)
            if own.any():
                pair = kane[path][:, own], absolute[path][:, own]
                yield _largest(f"{kind} {name}", unit + per, kane, *pair)


def _largest(name, unit, kane, one, other, scale=None):
    return largest_difference(name, unit, kane["time"], one, other, scale)


COMPARED = {
    "dafms": ("Kane's equations and absolute coordinates", _tree_differences),
    "young": (young.FORMULATIONS, young.young_differences),
    "vsdf": (frames.FORMULATIONS, frames.frame_differences),
}
