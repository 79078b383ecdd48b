"""Bodies of a VSDF deck: masses or finite-element files, frames and bases, nodes, initial motion."""

import math
from pathlib import Path

import numpy as np

from ..read.fe_files.formats import NEEDS_MAPPING
from ..read.fe_files.matrix_file import FEFileFault
from ..read.fe_files.node_table import read_node_table
from .deck_values import DeckValues
from .findings import Findings
from .flexible_body import BrickMaterial, FEFile, FlexibleInput, UnitLoad
from .vsdf_model import GROUND, RigidMass, VsdfBody

_UNIT_LENGTH = 1e-6
_TRIANGLE = 1e-9
_FLEXIBLE_ONLY = (
    ("node_table", "FEMN"),
    ("mass_matrix", "FEMM"),
    ("stiffness_matrix", "FEMK"),
    ("mapping", "FEMP"),
    ("damping", "DAMP"),
    ("stiffening", "GEOS"),
    ("unit_load", "FEMG"),
)
_LISTS = (("clamped", "CLMP"), ("attachment", "ATTM"), ("interface", "CRBN"))


def build_bodies(values: DeckValues, folder: Path, findings: Findings) -> tuple[VsdfBody, ...]:
    """The bodies in order; file names are relative to `folder`; faults go to `findings`."""
    count = len(values.section("body"))
    _check_body_numbers(values, count, findings)
    return tuple(_body(values, k, folder, findings) for k in range(1, count + 1))


def build_ground(values: DeckValues, findings: Findings) -> VsdfBody:
    """The ground with its nodes."""
    nodes = _given_nodes(values, 0, findings)
    return VsdfBody("ground", (0.0,) * 3, (1.0, 0.0, 0.0, 0.0), nodes=nodes)


def _check_body_numbers(values, count, findings):
    """Every card of a body must name one that exists."""
    sections = [name for name, _ in (*_FLEXIBLE_ONLY, *_LISTS)]
    sections += ["rigid", "node_set", "position", "attitude", "velocity", "node"]
    for section in sections:
        for record in values.section(section):
            number = record.at("body")
            lowest = 0 if section == "node" else 1
            if not lowest <= number.value <= count:
                message = f"body number {number.value} is outside {lowest}..{count}"
                findings.error(record.subject, message, number.place)


def _body(values, k, folder, findings) -> VsdfBody:
    record = values.record("body", k)
    flexible = record["kind"] == "FLEX"
    r = values.record("position", k)
    velocity = values.record("velocity", k)
    pose = {
        "r": r.vector("r") if r else (0.0, 0.0, 0.0),
        "p": _attitude(values.record("attitude", k), findings),
        "velocity": velocity.vector("v") if velocity else (0.0, 0.0, 0.0),
        "omega": velocity.vector("w") if velocity else (0.0, 0.0, 0.0),
        "place": record.place,
        "velocity_place": velocity.place if velocity else None,
    }
    build = _flexible if flexible else _rigid
    return build(values, k, record, pose, folder, findings)


def _attitude(record, findings):
    if record is None:
        return 1.0, 0.0, 0.0, 0.0
    p = tuple(float(record[f"e{i}"]) for i in range(4))
    length = math.hypot(*p)
    if not length:
        message = "the Euler parameters are all zero; write 1 0 0 0 for a body that is not turned"
        findings.error(record.subject, message, record.at("e0").place)
        return 1.0, 0.0, 0.0, 0.0
    if abs(length - 1.0) > _UNIT_LENGTH:
        message = f"the Euler parameters have length {length:.7g} and are scaled to length 1"
        findings.warn(record.subject, message, record.at("e0").place)
    return tuple(e / length for e in p)


def _rigid(values, k, record, pose, _folder, findings):
    for section, word in (*_FLEXIBLE_ONLY, *_LISTS):
        for given in values.section(section):
            if given["body"] == k:
                findings.error(given.subject, f"{word} is for FLEX bodies; body {k} is RIGD", given.place)
    rigid = values.record("rigid", k)
    if rigid is None:
        findings.error(
            record.subject, "a RIGD body needs a card RIGI with its mass and inertia", record.place
        )
    mass = _rigid_mass(rigid, findings) if rigid else None
    nodes = _given_nodes(values, k, findings)
    return VsdfBody(record.subject, **pose, rigid=mass, nodes=nodes, sets=_sets(values, k, nodes, findings))


def _rigid_mass(record, findings) -> RigidMass:
    if not record["mass"] > 0:
        message = f"the mass must be above zero; read {record.at('mass').text}"
        findings.error(record.subject, message, record.at("mass").place)
    xx, yy, zz, xy, yz, zx = (float(record[f"J{ij}"]) for ij in ("xx", "yy", "zz", "xy", "yz", "zx"))
    inertia = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
    moments = np.linalg.eigvalsh(inertia)
    if not moments[0] > 0:
        message = f"the principal moments of inertia must be above zero; the least is {moments[0]:.6g} kg m^2"
        findings.error(record.subject, message, record.at("Jxx").place)
    elif moments[2] > (moments[0] + moments[1]) * (1 + _TRIANGLE):
        message = (
            f"no body has the principal moments {moments[0]:.6g}, {moments[1]:.6g}, {moments[2]:.6g} kg m^2: "
            "the largest must not exceed the sum of the others (the moments are about the centre of mass)"
        )
        findings.error(record.subject, message, record.at("Jxx").place)
    return RigidMass(float(record["mass"]), record.vector("c"), inertia)


def _given_nodes(values, k, findings):
    nodes = {}
    for record in values.section("node"):
        if record["body"] != k:
            continue
        number = record["node"]
        if number in nodes:
            owner = f"body {k}" if k else "the ground"
            findings.error(record.subject, f"{owner} already has a node {number}", record.at("node").place)
        if number < 1:
            message = f"node numbers begin at 1; read {number}"
            findings.error(record.subject, message, record.at("node").place)
        nodes[number] = np.array(record.vector("r"))
    return nodes


def _sets(values, k, nodes, findings):
    sets = {}
    for record in values.section("node_set"):
        if record["body"] != k:
            continue
        number = record.at("set")
        members = _members(record, nodes, k, findings)
        _check_once(record, sets.get(number.value, ()), findings)
        if number.value in nodes:
            message = f"{number.value} is a node of body {k}; a set needs a number of its own"
            findings.error(record.subject, message, number.place)
        elif number.value < 1:
            findings.error(record.subject, f"sets are numbered from 1; read {number.text}", number.place)
        elif members:
            sets[number.value] = sets.get(number.value, ()) + members
    return sets


def _check_once(record, before, findings):
    """A set is the mean of its nodes: one that it names twice would count double."""
    seen = set(before)
    for number in record.numbers[2:]:
        if number.value in seen:
            findings.error(record.subject, f"node {number.value} is in the set already", number.place)
        seen.add(number.value)


def _members(record, nodes, k, findings):
    """The nodes a card lists that exist; the others are faults."""
    members = []
    for number in record.numbers:
        if not number.key.startswith("node"):
            continue
        if number.value in nodes:
            members.append(number.value)
        else:
            findings.error(record.subject, f"body {k} has no node {number.value}", number.place)
    return tuple(members)


def _flexible(values, k, record, pose, folder, findings):
    for section, word in (("rigid", "RIGI"), ("node", "NODE")):
        for given in values.section(section):
            if given["body"] == k:
                findings.error(given.subject, f"{word} is for RIGD bodies; body {k} is FLEX", given.place)
    table = _node_table(values, k, record, folder, findings)
    files = {name: _file(values.record(name, k), folder) for name, _ in _FLEXIBLE_ONLY[:4]}
    for name, word in _FLEXIBLE_ONLY[1:3]:
        if files[name] is None:
            findings.error(record.subject, f"a FLEX body needs a card {word}", record.place)
    _check_mapping(values.record("mapping", k), files, findings)
    _check_shapes(values, k, findings)
    if table is None or None in (files["mass_matrix"], files["stiffness_matrix"]):
        return VsdfBody(record.subject, **pose)
    nodes = dict(zip(map(int, table.numbers), table.positions, strict=True))
    sets = _sets(values, k, nodes, findings)
    given = FlexibleInput(
        record.subject,
        files["mass_matrix"],
        files["stiffness_matrix"],
        table.numbers,
        table.positions,
        files["mapping"],
        _reference(record, nodes, k, findings),
        **_node_lists(values, k, nodes, sets, findings),
        modes=_modes(record, findings),
        damping=_damping(values.record("damping", k), findings),
        unit_loads=_unit_loads(values, k, folder, findings),
        bricks=_bricks(values.record("stiffening", k), files["node_table"], findings),
        place=record.place,
    )
    stiffened = _stiffened(values.record("stiffening", k), given, findings)
    return VsdfBody(record.subject, **pose, flexible=given, nodes=nodes, sets=sets, stiffened=stiffened)


def _file(record, folder) -> FEFile | None:
    if record is None:
        return None
    return FEFile(folder / record["file"].replace("\\", "/"), record["form"], record.at("file").place)


def _check_mapping(record, files, findings):
    """Rows of the other formats follow the node table, whatever a mapping says."""
    forms = {files[name].form for name in ("mass_matrix", "stiffness_matrix") if files[name]}
    if record and forms and not forms & set(NEEDS_MAPPING):
        which = " and ".join(NEEDS_MAPPING)
        message = f"the mapping is not read: only matrices of format {which} have one; remove the card"
        findings.error(record.subject, message, record.place)


def _check_shapes(values, k, findings):
    """The interface nodes of Craig and Bampton's method have their static shapes; no others are added."""
    bodies = [record["body"] for record in values.section("interface")]
    for record in values.section("attachment"):
        if record["body"] == k and k in bodies:
            message = f"ATTM is not read beside CRBN of body {k}; name its nodes on CRBN, or remove CRBN"
            findings.error(record.subject, message, record.place)


def _node_table(values, k, record, folder, findings):
    given = _file(values.record("node_table", k), folder)
    if given is None:
        findings.error(record.subject, "a FLEX body needs a card FEMN", record.place)
        return None
    try:
        return read_node_table(given.path, given.form)
    except FEFileFault as fault:
        findings.error(record.subject, str(fault), given.place)
        return None


def _reference(record, nodes, k, findings):
    """Three nodes, or none at all: mean axes, or the frame of the clamped nodes."""
    numbers = [record.at(f"n{i}") for i in (1, 2, 3)]
    if not any(number.value for number in numbers):
        return ()
    for number in numbers:
        if number.value not in nodes:
            message = (
                f"reference node {number.key} is {number.value}, which body {k} does not have"
                if number.value
                else f"reference node {number.key} is missing; give three, or none for mean axes"
            )
            findings.error(record.subject, message, number.place)
    values = tuple(number.value for number in numbers)
    if len(set(values)) < 3 and 0 not in values:
        findings.error(record.subject, "the three reference nodes must differ", numbers[0].place)
        return ()
    return values if all(value in nodes for value in values) else ()


def _modes(record, findings):
    number = record.at("modes")
    if number.value < 0:
        findings.error(record.subject, f"a number of modes is 0 or more; read {number.text}", number.place)
        return 0
    return number.value


def _node_lists(values, k, nodes, sets, findings):
    """Nodes that the cards CLMP, ATTM, CRBN name, sets taken apart."""
    known = {**{number: (number,) for number in nodes}, **sets}
    lists = {}
    for section, _ in _LISTS:
        found = []
        for record in values.section(section):
            if record["body"] == k:
                found += [n for m in _members(record, known, k, findings) for n in known[m]]
        lists[section] = tuple(dict.fromkeys(found))
    return lists


def _damping(record, findings):
    if record is None:
        return 0.0, 0.0, 0.0
    for key in ("alpha", "beta", "ratio"):
        if record[key] < 0:
            message = f"{key} = {record.at(key).text}: negative damping feeds energy in"
            findings.error(record.subject, message, record.at(key).place)
    return tuple(float(record[key]) for key in ("alpha", "beta", "ratio"))


def _unit_loads(values, k, folder, findings):
    loads = []
    for record in values.section("unit_load"):
        if record["body"] != k:
            continue
        number = record.at("load")
        if not 4 <= number.value <= 12:
            message = f"unit load {number.value}: only 4 to 12 (xx xy xz yx yy yz zx zy zz) are used"
            findings.error(record.subject, message, number.place)
            continue
        i, j = divmod(number.value - 4, 3)
        if any((load.i, load.j) == (i, j) for load in loads):
            findings.error(record.subject, f"unit load {number.value} is given twice", number.place)
        loads.append(UnitLoad(i, j, _file(record, folder)))
    return tuple(loads)


def _bricks(record, file, findings) -> BrickMaterial | None:
    """The material that GEOS gives, to find stresses with."""
    if record is None or not record["on"] or not record.at("E").text:
        return None
    young, poisson = float(record["E"]), float(record["nu"])
    if not young > 0:
        message = f"Young's modulus must be above zero; read {record.at('E').text}"
        findings.error(record.subject, message, record.at("E").place)
    if not -1 < poisson < 0.5:
        message = f"Poisson's ratio lies between -1 and 0.5; read {record.at('nu').text}"
        findings.error(record.subject, message, record.at("nu").place)
    return BrickMaterial(file, young, poisson, record.at("E").place)


def _stiffened(record, given, findings):
    if record and record["on"] not in (0, 1):
        message = f"on is 0 or 1; read {record.at('on').text}"
        findings.error(record.subject, message, record.at("on").place)
    if record is None or not record["on"]:
        if given.unit_loads:
            message = f"FEMG is not used: GEOS does not switch stiffening on for {given.name}"
            findings.warn(given.name, message, given.unit_loads[0].file.place)
        return False
    if given.unit_loads and given.bricks:
        message = "stiffening comes either from the matrices of FEMG or from bricks; leave E out, or FEMG"
        findings.error(record.subject, message, record.at("E").place)
    if not given.unit_loads and not given.bricks:
        message = (
            "centrifugal stiffening needs geometric stiffness matrices, cards FEMG, or E and nu of the "
            "bricks in the node table's file"
        )
        findings.error(record.subject, message, record.at("on").place)
    return True


def end_of_body(number: int) -> int:
    """The model's number of a deck's body: from 0, ground -1."""
    return GROUND if number == 0 else number - 1
