"""The tree of a DAFMS deck as the options of a run want it integrated, and its solution in memory."""

from ..deck.record import Deck
from ..dialects.dafms.build import build_dafms
from ..model.tree import Tree, default_tolerances
from ..quick_dataclass import replace
from ..solvers.compilation import tell_of_compiling
from .integration_options import refuse_foreign_method
from .outcome import Outcome, RunOptions, refuse_warnings
from .young import Contents, Solution


def tree_of(deck: Deck, options: RunOptions, outcome: Outcome) -> Tree:
    """The tree of `deck`, to be integrated as `options` say; its warnings go into `outcome`."""
    refuse_foreign_method("dafms", options)
    tree, warnings = build_dafms(deck)
    outcome.faults += warnings
    refuse_warnings(outcome, options)
    return replace(tree, integration=replace(tree.integration, **_integration(deck, options)))


def _integration(deck, options):
    """Return what the options change; another method has another tolerance, where none is given."""
    given = dict(options.integration)
    if "method" in given and not deck.section("tolerance"):
        rtol, atol = default_tolerances(given["method"])
        given = {"rtol": rtol, "atol": atol} | given
    return given


def dafms_solution(deck: Deck, options: RunOptions, outcome: Outcome, listener) -> Solution:
    """The motion of a deck's tree, ready to be solved; warnings go into `outcome`.  Raises ModelError."""
    tree = tree_of(deck, options, outcome)
    from ..results.hdf5.tree import tree_layout, tree_values
    from ..solvers.tree.analysis import TreeAnalysis
    from ..solvers.tree.points import point_motion, point_names

    tell_of_compiling(listener, "integrators.tree_dop853.call")
    contents = Contents(
        lambda: tree_layout(tree, point_names(tree)),
        lambda rows: tree_values(tree, rows, point_motion(tree, rows)),
    )
    return Solution(TreeAnalysis(tree), tree.time.rows, contents)
