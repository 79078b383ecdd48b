"""The same VSDF deck with the reference nodes n1 and n2 of its flexible bodies exchanged.

n2 keeps to the axis through n1: the second frame has another origin, which moves against the first as the
body stretches, other axes, modes and invariants.  With all modes both hold the same deformations, and a shift
of the origin strains nothing: the two models are one and the same.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...deck.record import Deck, Number, Record
from ...errors import Fault, ModelError
from ...fe.build_mechanism import flexible_mechanism
from ...model.flexible_mechanism import FlexibleMechanism
from ...model.vectors import rotation_matrix
from ..elements_block.line import lines_of
from .build import build_vsdf

BY_FRAMES = ("REVO", "CYLI")  # joints without third nodes, whose angle is that of the frames


def exchanged_model(deck: Deck, folder: Path, first: FlexibleMechanism) -> FlexibleMechanism:
    """Return the mechanism in the other frames, its bodies moving as those of the first.

    Raises ModelError where there is no other frame of the same model.
    """
    _refuse_unequal(deck)
    changes: dict[Any, Any] = {}
    for record in deck.section("body"):
        if record["kind"] == "FLEX":
            changes |= {f"{record.prefix}.n1": record["n2"], f"{record.prefix}.n2": record["n1"]}
    model, _ = build_vsdf(deck.with_values(changes), folder)
    second, _ = flexible_mechanism(model)
    pairs = list(zip(first.bodies, second.bodies, strict=True))
    forces = tuple(_turned(force, *pairs[force.point.body]) for force in second.forces)
    return replace(second, bodies=tuple(_moving(*pair) for pair in pairs), forces=forces)


def _moving(body: Any, other: Any) -> Any:
    """Return `other` with the motion that `body` has at the start."""
    A, B = rotation_matrix(body.p), rotation_matrix(other.p)
    omega = A @ body.omega
    return replace(other, velocity=body.velocity + np.cross(omega, other.r - body.r), omega=B.T @ omega)


def _turned(force: Any, body: Any, other: Any) -> Any:
    """Return a force that follows its body in the axes of the other frame."""
    if not force.follows:
        return force
    turned = rotation_matrix(other.p).T @ rotation_matrix(body.p) @ force.force
    return replace(force, force=tuple(turned))


def _refuse_unequal(deck: Deck) -> None:
    """Only with all modes, and frames by three nodes, is there another frame of the same model."""
    faults, elastic = [], [record for record in deck.section("body") if record["kind"] == "FLEX"]
    clamped = {r["body"] for name in ("clamped", "interface") for r in deck.section(name)}
    for record in elastic:
        nodes = [record[f"n{k}"] for k in (1, 2, 3)]
        if record["modes"]:
            message = "verify compares two frames of the same body, which takes all modes: give 0 modes"
            faults.append(Fault("error", message, record.at("modes").place, record.subject, id="RUN-019"))
        if not all(nodes) or record["number"] in clamped:
            message = "verify exchanges the reference nodes n1 and n2: give three, and neither CLMP nor CRBN"
            faults.append(Fault("error", message, record.place, record.subject, id="RUN-020"))
    if not elastic:
        faults.append(
            Fault("error", "verify compares two frames of a FLEX body; the deck has none", id="RUN-021")
        )
    numbers = {record["number"] for record in elastic}
    faults += _of_frames(deck, {record["number"] for record in elastic})
    for motion in deck.section("motion"):
        if motion["kind"] not in ("ANGL", "STRK") and motion["object"] in numbers:
            message = "it moves the frame of a FLEX body, which is another in the second model"
            faults.append(Fault("error", message, motion.place, motion.subject, id="RUN-022"))
    if faults:
        raise ModelError(faults)


def _of_frames(deck: Deck, flexible: set[int]) -> Iterator[Fault]:
    """Elements that act on the frame of a FLEX body, which is another in the second model."""
    for line in lines_of(deck):
        if line.word == "BUSHING" and line["from.body"] in flexible:
            message = (
                "it acts along the axes of the frame of a FLEX body, which are others in the second model"
            )
            yield Fault("error", message, line.at("from.body").place, line.subject, id="VSDF-108")
    joints = {joint["number"]: joint for joint in deck.section("joint")}
    for record, number, named in _angles(deck):
        joint = joints[named]
        if {joint["a"], joint["b"]} & flexible and joint["kind"] in BY_FRAMES:
            message = "it acts in an angle of the frame of a FLEX body, which is another in the second model"
            yield Fault("error", message, number.place, record.subject, id="VSDF-109")


def _angles(deck: Deck) -> Iterator[tuple[Record, Number, int]]:
    """Yield the numbers by which elements name an angle, or a joint with friction, and the joint."""
    for record in deck.section("joint_spring"):
        yield record, record.at("joint"), record["joint"]
    for line in lines_of(deck):
        for number in line.numbers if line.word not in ("START", "DRIVE", "OUTPUT", "MASS") else ():
            joint, _, coordinate = str(number.value if number.key == "at" else number.key).partition(".")
            if number.key == "joint":
                yield line, number, number.value
            elif coordinate == "angle" and joint.isdigit():
                yield line, number, int(joint)
