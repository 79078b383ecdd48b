"""Report rows of decks and trees with elements: what every element does and bears."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Any, TypeVar

import numpy as np

from ...kernels.constrained.report import Report
from ...kernels.contact import CHANGED, CONTACT_COLUMNS, PLACE, PUSH, TOUCHES
from ...kernels.laws import COORDINATE, EFFORT, ENERGY, POWER, SPEED
from ...model.arrays.dynamic import DynamicArrays
from ...model.arrays.system import SystemArrays
from ...model.flexible_mechanism import FlexibleMechanism
from ...model.general_joints import GeneralJoint
from ...model.joint_elements import JointElements, names_of, parts_in_arrays
from ...model.laws import CONTACT, DRIVING, FRICTION
from ...model.loads import DynamicModel
from ...model.vectors import cross_rows, global_axes
from .flexible_rows import FlexibleRows, flexible_rows
from .rows import DynamicRows, dynamic_rows

R = TypeVar("R")  # a type of rows


@dataclass(frozen=True)
class ElementAnswers:
    """Answers of elements in rows of all analyses; those in angles in rad, rad/s and N m."""

    element_coordinate: np.ndarray  # (T, elements) length, stroke or angle; 0 of friction
    element_rate: np.ndarray  # (T, elements)
    element_effort: np.ndarray  # (T, elements) drives the coordinate to larger values
    element_power: np.ndarray  # (T, elements) W, of dampers, friction and motors
    element_energy: np.ndarray  # (T, elements) J, what it stores
    element_work: np.ndarray  # (T, elements) J, integral of its power since the start
    dissipated: np.ndarray  # (T,) J, what all elements but motors have dissipated since the start
    coupling_effort: np.ndarray  # (T, couplings) times its factor: what acts in a coordinate, N or N m
    contact_force: np.ndarray  # (T, contacts, 3) on the second body, global axes, N
    contact_place: np.ndarray  # (T, contacts, 3) where it acts, global axes, m
    contact_touches: np.ndarray  # (T, contacts) how often it has begun
    signal_value: np.ndarray  # (T, signals with names)
    contact_changed: np.ndarray  # (T, contacts) when it began or ended last, s
    curve_position: np.ndarray  # (T, curves) arc length from the curve's beginning, m
    curve_speed: np.ndarray  # (T, curves) its rate, m/s
    curve_force: np.ndarray  # (T, curves, 3) on the point, global axes, N
    general_force: np.ndarray  # (T, general joints, 3) on body J, global axes, N
    general_torque: np.ndarray  # (T, general joints, 3) on body J about P_j, global axes, N m
    roll_force: np.ndarray  # (T, rolls, 3) on what rolls, at the contact, global axes, N


@dataclass(frozen=True)
class ElementRows(ElementAnswers, DynamicRows):
    """Rows of a YOUNG deck with elements."""

    composite_force: np.ndarray  # (T, composite joints, 3) on body J, global axes, N
    composite_torque: np.ndarray  # (T, composite joints, 3) on body J about P_j, global axes, N m


def joined(rows_type: Callable[..., R], rows: Any, **more: Any) -> R:
    """Rows of the type `rows_type`: fields of `rows`, and those that are given."""
    known = {field.name: getattr(rows, field.name) for field in fields(rows)}
    return rows_type(**{**known, **more})


def element_rows(model: DynamicModel, arrays: DynamicArrays, report: Report) -> ElementRows:
    """The rows of a report in the terms of the model."""
    ordered = report._replace(wrenches=_in_order_of_deck(model, arrays, report))
    rows = dynamic_rows(model, ordered, arrays.place_of_work)
    own = report.multipliers[:, report.multipliers.shape[1] - len(model.elements.drivers) :]
    first = len(model.forces) + len(model.torques)
    return joined(
        ElementRows,
        rows,
        driver_effort=np.concatenate([rows.driver_effort, own], axis=1),
        **element_answers(report, first, model.elements),
        coupling_effort=coupling_efforts(report, arrays, model.elements),
        curve_force=curve_forces(report, arrays, model.elements),
        **roll_forces(report, arrays, model.elements),
        **general_forces(report, first_general(arrays, model.elements), model.elements.generals),
        **_composite_forces(model, arrays, report),
    )


def coupling_efforts(
    report: Report, arrays: SystemArrays, elements: JointElements, behind: int = 0
) -> np.ndarray:
    """Multipliers (T, couplings); `behind`: groups of equations behind those of couplings and drivers."""
    end = len(arrays.groups) - behind - len(elements.drivers)
    groups = arrays.groups[end - len(elements.couplings) : end]
    scales = np.array([item.scale for item in elements.couplings])
    return report.multipliers[:, groups["first_row"]] / scales + 0.0


def curve_forces(report: Report, arrays: SystemArrays, elements: JointElements) -> np.ndarray:
    """Forces (T, curves, 3) on the points, global axes; the ground's are those that body I bears."""
    return _forces(report, first_general(arrays, elements) + len(elements.generals), elements.curves)


def roll_forces(report: Report, arrays: SystemArrays, elements: JointElements) -> dict[str, np.ndarray]:
    """Forces (T, rolls, 3) on what rolls, whose groups precede those of general joints."""
    first = first_general(arrays, elements) - len(elements.rolls)
    return {"roll_force": _forces(report, first, elements.rolls)}


def _forces(report: Report, first: int, items: Sequence[Any]) -> np.ndarray:
    """Forces (T, items, 3) on body J, or that body I bears, of groups from `first` on."""
    forces = np.zeros((len(report.times), len(items), 3))
    for k, item in enumerate(items):
        side, sign = (1, 1.0) if item.j >= 0 else (0, -1.0)
        forces[:, k] = sign * report.wrenches[:, first + k, side, :3] + 0.0
    return forces


def curve_motion(elements: JointElements, parameters: np.ndarray, rates: np.ndarray) -> dict[str, np.ndarray]:
    """Fields of `ElementAnswers` of points on curves, from the parameters (T, curves) and their rates."""
    position, speed = np.zeros(parameters.shape), np.zeros(parameters.shape)
    for k, curve in enumerate(elements.curves):
        position[:, k] = curve.lengths(parameters[:, k])
        speed[:, k] = rates[:, k] * np.linalg.norm(curve.at(parameters[:, k])[1], axis=1)
    return {"curve_position": position, "curve_speed": speed}


def first_general(arrays: SystemArrays, elements: JointElements) -> int:
    """Return the number of the first group of equations of general joints, which those of curves follow."""
    return (
        len(arrays.groups)
        - len(elements.drivers)
        - len(elements.couplings)
        - len(elements.curves)
        - len(elements.generals)
    )


def general_forces(report: Report, first: int, joints: Sequence[GeneralJoint]) -> dict[str, np.ndarray]:
    """Fields of `ElementAnswers` of general joints, whose groups of equations begin with number `first`.

    A node of a flexible body bears no torque.
    """
    force, torque = (np.zeros((len(report.times), len(joints), 3)) for _ in range(2))
    for k, joint in enumerate(joints):
        P_j = getattr(joint.P_j, "r0", joint.P_j)
        force[:, k], moment = _wrench(report, first + k, joint.i, joint.j, P_j)
        torque[:, k] = moment if joint.holds_turns else 0.0
    return {"general_force": force, "general_torque": torque}


def _wrench(report: Report, group: int, i: int, j: int, P_j: Any) -> tuple[np.ndarray, np.ndarray]:
    """Force and torque (T, 3) of a group on body J at P_j: the ground bears what body I does."""
    side, sign, body = (1, 1.0, j) if j >= 0 else (0, -1.0, i)
    wrench = sign * report.wrenches[:, group, side] + 0.0
    q = report.states[:, 7 * body : 7 * body + 7]
    arm = global_axes(q[:, 3:], np.array([P_j])) if j >= 0 else P_j - q[:, :3]
    return wrench[:, :3], global_axes(q[:, 3:], wrench[:, 3:]) - cross_rows(arm, wrench[:, :3])


def _composite_forces(model: DynamicModel, arrays: DynamicArrays, report: Report) -> dict[str, np.ndarray]:
    """Forces and torques (T, composite joints, 3) on body J at P_j."""
    composites = model.elements.composites
    first = first_general(arrays, model.elements) - len(model.elements.rolls) - len(composites)
    force, torque = (np.zeros((len(report.times), len(composites), 3)) for _ in range(2))
    for k, item in enumerate(composites):
        force[:, k], torque[:, k] = _wrench(report, first + k, item.i, item.j, item.P_j)
    return {"composite_force": force, "composite_torque": torque}


def element_answers(report: Report, first: int, elements: JointElements) -> dict[str, Any]:
    """Fields of `ElementAnswers` that the loads from `first` on answer."""
    answers = report.responses[:, first:]
    works = report.states[:, report.states.shape[1] - answers.shape[1] :]
    end = answers.shape[1] - len(elements.of(FRICTION))
    probes = np.arange(end - len(elements.curves), end)
    tracks = answers[:, probes]
    springs = answers.shape[1] - len(probes) - len(list(names_of(elements)))
    without_probes = np.delete(answers, probes, axis=1), np.delete(works, probes, axis=1)
    return {
        **curve_motion(elements, tracks[..., COORDINATE], tracks[..., SPEED]),
        **answers_of(elements, *without_probes, report.signals, springs),
    }


def answers_of(
    elements: JointElements, answers: np.ndarray, works: np.ndarray, signals: np.ndarray, springs: int = 0
) -> Any:
    """Fields of `ElementAnswers`: `answers` (T, E, columns) and `works` (T, E) begin with so many springs.

    signals (T, S): values of all signals.
    """
    parts = parts_in_arrays(elements.forces)
    order = [*range(springs), *(springs + place for _, place in parts)]
    motors = np.array(springs * [False] + [item.law in DRIVING for item, _ in parts], bool)
    # A force of none is 0, not -0.
    efforts, works = answers[:, order] + 0.0, works[:, order] + 0.0
    columns = {"coordinate": COORDINATE, "rate": SPEED, "effort": EFFORT, "power": POWER, "energy": ENERGY}
    return {
        **{f"element_{name}": efforts[..., column].copy() for name, column in columns.items()},
        "element_work": works,
        "signal_value": signals[:, [k for k, s in enumerate(elements.signals) if s.name]] + 0.0,
        # 0 - x, unlike -x, leaves no negative zeros.
        "dissipated": 0.0 - np.sum(works[:, ~motors], axis=1),
        **_contacts(efforts[:, [springs + k for k, (item, _) in enumerate(parts) if item.law is CONTACT]]),
    }


def _contacts(answers: np.ndarray) -> dict[str, np.ndarray]:
    """Fields of `ElementAnswers` that only contacts have, from their answers (T, contacts, columns)."""
    if not answers.shape[1]:
        answers = np.zeros((len(answers), 0, CONTACT_COLUMNS))
    return {
        "contact_force": answers[..., PUSH : PUSH + 3].copy(),
        "contact_place": answers[..., PLACE : PLACE + 3].copy(),
        "contact_touches": answers[..., TOUCHES].copy(),
        "contact_changed": answers[..., CHANGED].copy(),
    }


def _in_order_of_deck(model: DynamicModel, arrays: DynamicArrays, report: Report) -> Any:
    """Wrenches (T, groups, 2, 6) of the deck's constraints, those that follow functions in their places."""
    mechanism, elements = model.mechanism, model.elements
    own = len(arrays.kinematic.constraints)
    others = report.wrenches[:, own:]
    wrenches = report.wrenches[:, :own]
    first = len(mechanism.joints)
    places = [(first + item.item, len(elements.driven) + k) for k, item in enumerate(elements.supports)]
    first += len(mechanism.simplified) + len(mechanism.distances)
    places += [(first + item.item, k) for k, item in enumerate(elements.driven)]
    for place, k in sorted(places):
        # The body of a function's equation is its body J, that of a driver or support its body I.
        wrenches = np.insert(wrenches, place, others[:, k, ::-1], axis=1)
    return wrenches


@dataclass(frozen=True)
class FlexibleElementRows(ElementAnswers, FlexibleRows):
    """Rows with springs and elements."""


def flexible_element_rows(
    mechanism: FlexibleMechanism, arrays: SystemArrays, report: Report
) -> FlexibleElementRows:
    """The rows of a report in the terms of the model."""
    rows = flexible_rows(mechanism, arrays, report)
    first = len(mechanism.forces) + len(mechanism.torques)
    return joined(
        FlexibleElementRows,
        rows,
        **element_answers(report, first, mechanism.elements),
        coupling_effort=coupling_efforts(report, arrays, mechanism.elements),
        curve_force=curve_forces(report, arrays, mechanism.elements),
        **roll_forces(report, arrays, mechanism.elements),
        **general_forces(report, first_general(arrays, mechanism.elements), mechanism.elements.generals),
    )
