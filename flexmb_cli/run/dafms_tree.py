"""The tree of a DAFMS deck as it will be integrated, refused where this version would leave something out."""

from dataclasses import replace

from ..errors import Fault, ModelError
from ..model.build_dafms import build_dafms
from ..model.tree import Tree
from ..read.deck import Deck
from .outcome import Outcome, RunOptions, refuse_warnings

INTEGRATORS = ("dop853",)


def tree_of(deck: Deck, options: RunOptions, outcome: Outcome) -> Tree:
    """The tree of `deck`, to be integrated as `options` say; its warnings go into `outcome`.

    Raises ModelError for what this version cannot integrate.
    """
    tree, warnings = build_dafms(deck)
    outcome.faults += warnings
    refuse_warnings(outcome, options)
    tree = replace(tree, integration=replace(tree.integration, **options.integration))
    faults = [*_left_out_integrator(tree, deck, options), *_left_out_rotations(tree, deck)]
    if faults:
        raise ModelError(faults)
    return tree


def _left_out_integrator(tree, deck, options):
    method = tree.integration.method
    if method in INTEGRATORS:
        return
    records = () if "method" in options.integration else deck.section("method")
    message = (
        f"integrator {method} is not part of this version; {INTEGRATORS[0]} (1) integrates every deck, stiff "
        "elastic bodies by short steps"
    )
    yield Fault("error", message, records[0].place if records else None, "METH")


def _left_out_rotations(tree, deck):
    """NROT given for a node on which a hinge sits; for other nodes it turns nothing."""
    turned = {(h.parent + 1, h.node + 1) for h in tree.hinges if h.elastic_rotation is not None}
    for record in deck.section("nodal_rotation"):
        node = record["K"], record["I"]
        if node in turned:
            message = (
                f"the hinge on node {node[1]} of body {node[0]} cannot be turned by this version; without "
                "the card it keeps the attitude of the body's root"
            )
            yield Fault("error", message, record.place, record.subject)
