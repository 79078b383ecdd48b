"""The finite-element files of decks/vsdf/fe as inputs of flexible bodies."""

import functools
from pathlib import Path

from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.fe.formats.node_table import read_node_table
from flexmb_cli.model.flexible_body import FEFile, FlexibleInput, UnitLoad

FILES = Path(__file__).parents[2] / "decks" / "vsdf" / "fe"

# Format: mass, stiffness and mapping of the pendulum.
PENDULUM = {
    "MM": ("pendulum_M.mtx", "pendulum_K.mtx", None),
    "HB": ("pendulum_M.hb", "pendulum_K.hb", ("pendulum.mapping", "ANS")),
    "CCX": ("calculix/pendulum.mas", "calculix/pendulum.sti", ("calculix/pendulum.dof", "CCX")),
    "ABQ": ("pendulum_MASS1.mtx", "pendulum_STIF1.mtx", None),
    "OP4": ("pendulum_MK.op4", "pendulum_MK.op4", None),
    "DMIG": ("pendulum_M.pch", "pendulum_K.pch", None),
}
# Width 10 mm along y, thickness 15 mm along z, length 100 mm along x: nodes by the corners they are.
NEAR_JOINT, CHORD, OFF_LINE = (1, 13, 9), (1, 49, 5), (1, 7, 5)


@functools.cache
def nodes(name="pendulum_nodes.txt", form="TXT"):
    return read_node_table(FILES / name, form)


def pendulum(form="MM", **choices):
    """The pendulum's input in one format, reference nodes as the paper's where nothing else is chosen."""
    mass, stiffness, mapping = PENDULUM[form]
    if not choices.keys() & {"reference", "clamped", "mean"}:
        choices["reference"] = NEAR_JOINT
    choices.pop("mean", None)
    table = nodes()
    return FlexibleInput(
        "body 1",
        FEFile(FILES / mass, form),
        FEFile(FILES / stiffness, form),
        table.numbers,
        table.positions,
        mapping and FEFile(FILES / mapping[0], mapping[1]),
        **choices,
    )


def spin_up(**choices):
    """The cantilever of the spin-up, its root face clamped."""
    table = nodes("spinup_nodes.txt")
    loads = [
        UnitLoad(i, i, FEFile(FILES / f"spinup_KG_{name}.mtx", "MM")) for i, name in enumerate(("xx", "yy"))
    ]
    return FlexibleInput(
        "body 1",
        FEFile(FILES / "spinup_M.mtx", "MM"),
        FEFile(FILES / "spinup_K.mtx", "MM"),
        table.numbers,
        table.positions,
        clamped=(1, 2, 3, 4),
        unit_loads=tuple(loads),
        **choices,
    )


def body(given):
    """The flexible body of an input whose files leave no warning."""
    found, warnings = flexible_body(given, cached=False)
    assert warnings == []
    return found
