"""Bodies of FMBD.DAT: masses, inertia, loads, and the finite-element block of the flexible ones.

DAFMS thesis (Zhao, 1992), appendix C, DFIN (skyline, lumped masses) and TSYSIN (MASS, INER, RC, FORC,
TOQU).
"""

from typing import Any

import numpy as np

from ...deck.many_records import DeckValues
from ...model.diagnostics import Findings
from ...model.geometric_stiffness import beam_direction
from ...model.tree import Body, Elasticity
from .beam import full_matrix

AXES_BY_DOFS = {1: (3,), 2: (2, 3), 3: (1, 2, 3)}

# Five decimals are what an F10.5 field holds for certain: masses may miss their sum by half a unit each.
_LAST_DECIMAL = 5e-6

# The stiffness is held as a full matrix: beyond this many elastic coordinates it would take gigabytes.
LARGEST_BODY = 10_000

_NEEDED = (("MASS", "mass"), ("INER", "inertia"))
_ZERO = (0.0, 0.0, 0.0)


def build_bodies(values: DeckValues, findings: Findings) -> tuple[Body, ...]:
    """The N bodies, in order; faults go to `findings`."""
    count = values.number("counts", 0, "N").value
    missing = [card for card, section in _NEEDED if not values.section(section)]
    for card in missing:
        message = (
            f"card '{card}' is missing: it stands before 'END ', with a record for each of {count} bodies"
        )
        findings.error("", message, _cards_begin(values), id="DAFMS-008")
    if missing:
        return ()
    return tuple(_body(values, k, findings) for k in range(1, count + 1))


def _cards_begin(values: DeckValues) -> Any:
    """Return where cards are expected: at the last number of the time, which stands before them."""
    return values.number("time", 0, "H").place


def _body(values: DeckValues, k: int, findings: Findings) -> Body:
    name = f"body {k}"
    flexible = values.number("counts", k, "NUMNP").value > 0
    elastic = _elasticity(values, k, findings) if flexible else None
    if not flexible:
        _warn_of_unused_cards(values, k, findings)
    centre = values.values("mass_centre", k, _ZERO)
    if elastic is not None and any(centre):
        place = values.place("mass_centre", k)
        findings.warn(
            name, "RC is not used: the nodes of a flexible body say where its mass is", place, id="DAFMS-009"
        )
        centre = _ZERO
    torque = values.values("torque", k, _ZERO)
    if any(values.values("pulse", k, (0,))[:1]) and torque[0]:
        place = values.place("torque", k)
        findings.warn(
            name, f"HM1 = {torque[0]} of TOQU is replaced by the pulse of DESN", place, id="DAFMS-010"
        )
        torque = (0.0, *torque[1:])
    return Body(
        name,
        _mass(values, k, elastic, findings),
        _inertia(values, k, findings),
        centre,
        elastic,
        values.values("force", k, _ZERO),
        torque,
        values.place("mass", k),
    )


def _warn_of_unused_cards(values: DeckValues, k: int, findings: Findings) -> None:
    """ELDA and GSTF concern nodes: on a body without nodes they would have no effect."""
    for card, section in (("ELDA", "elastic_damping"), ("GSTF", "stiffening")):
        asked = values.values(section, k, (0,))
        if any(asked if card == "ELDA" else asked[:1]):
            message = f"{card} is not used: the body is rigid, NUMNP = 0"
            findings.warn(f"body {k}", message, values.place(section, k), id="DAFMS-011")


def _mass(values: DeckValues, k: int, elastic: Elasticity | None, findings: Findings) -> float:
    number = values.number("mass", k, "BM")
    mass, name = number.value, f"body {k}"
    if mass < 0:
        findings.error(name, f"BM = {mass}: a mass is not negative", number.place, id="DAFMS-012")
    if elastic is None:
        return float(mass)
    nodes = float(np.sum(elastic.masses))
    if mass < nodes - _LAST_DECIMAL * (len(elastic.masses) + 1):
        findings.error(
            name,
            f"BM = {mass} kg is less than the {nodes:.6g} kg of its nodes: BM is the mass of the whole body, "
            "nodes included",
            number.place,
            id="DAFMS-013",
        )
    return float(max(mass, nodes))


def _inertia(values: Any, k: int, findings: Findings) -> np.ndarray:
    moments = values.record("inertia", k).numbers
    for number in moments:
        if number.value < 0:
            message = f"{number.key} = {number.value}: a moment of inertia is not negative"
            findings.error(f"body {k}", message, number.place, id="DAFMS-014")
    products = values.values("product", k, _ZERO)
    inertia = np.diag([float(number.value) for number in moments])
    for (i, j), product in zip(((0, 1), (0, 2), (1, 2)), products, strict=True):
        inertia[i, j] = inertia[j, i] = product
    lowest = np.linalg.eigvalsh(inertia)[0] if any(products) and np.all(np.isfinite(inertia)) else 0.0
    if lowest < -2 * _LAST_DECIMAL and np.all(np.diag(inertia) >= 0):
        findings.error(
            f"body {k}",
            f"PROD and INER give a principal moment of inertia of {lowest:.4g} kg m^2, and no mass has a "
            "negative one: both are about O_k, I12 is -∫ x1 x2 dm",
            values.place("product", k),
            id="DAFMS-015",
        )
    return inertia


def _elasticity(values: DeckValues, k: int, findings: Findings) -> Elasticity | None:
    nodes = values.number("counts", k, "NUMNP").value
    axes = AXES_BY_DOFS[values.number("counts", k, "NDF").value]
    size = nodes * len(axes)
    if size > LARGEST_BODY:
        message = f"{size} elastic coordinates, more than {LARGEST_BODY}: condense the body first"
        findings.error(f"body {k}", message, values.number("counts", k, "NUMNP").place, id="DAFMS-016")
        return None
    masses = _nodal_masses(values, k, findings)
    stiffness = _stiffness(values, k, findings, axes)
    positions = _node_vectors(values, "node", k, nodes)
    return Elasticity(
        positions,
        masses,
        axes,
        stiffness,
        _node_vectors(values, "nodal_force", k, nodes),
        _damping(values, k, masses, stiffness, findings),
        _stiffened_from(values, k, positions, findings),
    )


def _stiffened_from(values: DeckValues, k: int, positions: np.ndarray, findings: Findings) -> float | None:
    """Clamped end of a beam that card GSTF stiffens, m from O_k; None for a body that is not."""
    asked, root = values.values("stiffening", k, (0, 0.0))
    if not asked:
        return None
    if beam_direction(positions, root) is None:
        findings.error(
            f"GSTF of body {k}",
            f"IGS = {asked}: geometric stiffening is that of a straight beam: its nodes have to lie apart on "
            f"one line from O_k, all farther out than the clamped end, RA = {root:g} m",
            values.place("stiffening", k),
            id="DAFMS-017",
        )
        return None
    return root


def _node_vectors(values: DeckValues, section: str, k: int, nodes: int) -> np.ndarray:
    """Three components a node (NP, 3); a planar deck gives axes 2 and 3 only."""
    vectors = np.zeros((nodes, 3))
    for i in range(nodes):
        given = values.values(f"{section}.{k}", i + 1, _ZERO)
        vectors[i, 3 - len(given) :] = given
    return vectors


def _nodal_masses(values: Any, k: int, findings: Findings) -> np.ndarray:
    record = values.record("bmi", k)
    masses = np.array(record.values, float)
    for node in np.flatnonzero(masses <= 0):
        number = record.numbers[node]
        message = f"{number.key} = {number.value}: every node needs a mass above zero"
        findings.error(f"body {k}", message, number.place, id="DAFMS-018")
    return masses


def _stiffness(values: Any, k: int, findings: Findings, axes: tuple[int, ...]) -> np.ndarray:
    matrix = full_matrix(values.record("counts.jdi", k).values, values.record("bkp", k).values)
    _check_definite(matrix, values, k, findings, axes)
    return matrix


def _check_definite(
    matrix: np.ndarray, values: Any, k: int, findings: Findings, axes: tuple[int, ...]
) -> None:
    try:
        np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        lowest, shapes = np.linalg.eigh(matrix)
        worst = int(np.argmax(np.abs(shapes[:, 0])))
        node, axis = worst // len(axes) + 1, axes[worst % len(axes)]
        jdi = values.record("counts.jdi", k).numbers[worst].value
        findings.error(
            f"body {k}",
            f"the stiffness is not positive definite (smallest eigenvalue {lowest[0]:.4g} N/m, most at node "
            f"{node}, axis {axis}): BKP is the matrix of the body clamped at O_k, upper triangle by columns, "
            "each from its first row down to the diagonal",
            values.record("bkp", k).numbers[jdi - 1].place,
            id="DAFMS-019",
        )


def _damping(
    values: DeckValues, k: int, masses: np.ndarray, stiffness: np.ndarray, findings: Findings
) -> np.ndarray | None:
    """Rayleigh damping ALPHA M + BETA K of card ELDA."""
    alpha, beta = values.values("elastic_damping", k, (0.0, 0.0))
    if alpha < 0 or beta < 0:
        message = f"ALPHA = {alpha}, BETA = {beta}: negative damping feeds energy in"
        findings.error(f"body {k}", message, values.place("elastic_damping", k), id="DAFMS-020")
    if not (alpha or beta):
        return None
    dofs = len(stiffness) // len(masses)
    return alpha * np.diag(np.repeat(masses, dofs)) + beta * stiffness
