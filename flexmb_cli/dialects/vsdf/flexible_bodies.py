"""A flexible body of a VSDF deck: its finite-element files, reference, basis, damping and stiffening."""

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...deck.many_records import DeckValues
from ...deck.record import Record
from ...fe.formats.formats import FORMS_WITH_ELEMENTS, OF_ELEMENTS, OF_STRUCTURES, TAKES_MAPPING
from ...fe.formats.matrix_file import FEFileFault
from ...fe.formats.node_table import NodeTable, read_node_table
from ...model.diagnostics import Findings
from ...model.fe_model import VsdfBody
from ...model.flexible_body import ElementMaterial, FEFile, FlexibleInput, UnitLoad
from .cards.bodies import MATRIX_SECTIONS
from .changed_matrices import changes_of_matrices
from .interface_nodes import carrying_arms, check_uses, interface_nodes
from .nodes import arms_of, members_of, sets_of

if TYPE_CHECKING:
    import numpy as np


def stiffening_material(
    values: DeckValues, k: int, file: FEFile, findings: Findings
) -> ElementMaterial | None:
    """Return the material that GEOS gives body k, or MATL where no matrices of FEMG stiffen it."""
    record, material = values.record("stiffening", k), values.record("material", k)
    if record is None or not record["on"]:
        return None
    if record.at("E").text:
        return _material(record, file, findings)
    matrices = any(load["body"] == k for load in values.section("unit_load"))
    return None if matrices or material is None else _material(material, file, Findings())


def matrices_of_elements(values: DeckValues, k: int, files: dict[str, Any]) -> dict[str, Any]:
    """Return the elements in place of both matrices where the deck has neither, but MATL with a density."""
    record, table = values.record("material", k), files["node_table"]
    given = files["mass_matrix"] or files["stiffness_matrix"]
    if record is None or not record.at("rho").text or given or table is None:
        return {}
    elements = FEFile(table.path, _form_of_elements(table), record.place)
    return {"mass_matrix": elements, "stiffness_matrix": elements}


def _form_of_elements(file: FEFile) -> str:
    """Return whether beams and shells are meant, or solid elements, whose reader reports faults."""
    from ...fe.formats.structure_elements import has_structures

    try:
        return OF_STRUCTURES if has_structures(file.path, file.form) else OF_ELEMENTS
    except FEFileFault:
        return OF_ELEMENTS


def stress_material(values: DeckValues, k: int, file: FEFile, findings: Findings) -> ElementMaterial | None:
    """Return the material that MATL gives body k, None where there is no such card."""
    record, types = values.record("material", k), values.record("element_types", k)
    if record is None:
        if types:
            message = f"ELMT describes the elements of a material; body {k} needs a card MATL"
            findings.error(types.subject, message, types.place, id="VSDF-211")
        return None
    density = record.at("rho")
    if density.text and not density.value > 0:
        message = f"a density must be above zero; read {density.text}"
        findings.error(record.subject, message, density.place, id="VSDF-088")
    material = _material(record, file, findings, float(density.value) if density.text else math.nan)
    return material if types is None else _of_types(values, k, types, material, findings)


def _of_types(
    values: DeckValues, k: int, record: Record, material: ElementMaterial, findings: Findings
) -> ElementMaterial:
    """Return the material with what the card ELMT says of its elements."""
    if record["types"] and material.file.form != "INP":
        message = (
            f"only INP files name types of elements, and the node table of body {k} is of format "
            f"{material.file.form}; leave the field empty"
        )
        findings.error(record.subject, message, record.at("types").place, id="VSDF-212")
    if record["mass"] and values.record("mass_matrix", k):
        message = f"the mass of body {k} is that of FEMM; leave the field empty"
        findings.error(record.subject, message, record.at("mass").place, id="VSDF-213")
    return replace(
        material,
        program=record["types"],
        lumped=record["mass"] == "LUMP",
        any_stiffness=bool(record["stress"]),
    )


def mesh_file(values: DeckValues, k: int, file: FEFile) -> FEFile | None:
    """Return the file of elements by which body `k` is drawn alone, None where `MATL` makes more of them."""
    return file if file.form in FORMS_WITH_ELEMENTS and not values.record("material", k) else None


def _material(record: Record, file: FEFile, findings: Findings, density: float = math.nan) -> ElementMaterial:
    young, poisson = float(record["E"]), float(record["nu"])
    if not young > 0:
        message = f"Young's modulus must be above zero; read {record.at('E').text}"
        findings.error(record.subject, message, record.at("E").place, id="VSDF-033")
    if not -1 < poisson < 0.5:
        message = f"Poisson's ratio lies between -1 and 0.5; read {record.at('nu').text}"
        findings.error(record.subject, message, record.at("nu").place, id="VSDF-034")
    return ElementMaterial(file, young, poisson, record.at("E").place, density)


_MATRICES = {"mass_matrix": "FEMM", "stiffness_matrix": "FEMK"}
_WORDS = _MATRICES | {"unit_load": "FEMG", "damping_matrix": "FEMD"}
_FILES = ("node_table", *_MATRICES, "damping_matrix", "mapping")
_LISTS = ("clamped", "attachment", "interface")


def flexible_body(
    values: DeckValues, k: int, record: Record, pose: dict[str, Any], folder: Path, findings: Findings
) -> VsdfBody:
    """Body k of the card `record`; `pose`: its place and first motion, `folder`: where its files are."""
    table = _node_table(values, k, record, folder, findings)
    names = _matrix_names(values, k, findings)
    files = _files(values, k, record, folder, names, findings)
    _check_shapes(values, k, findings)
    mass, stiffness, nodes_file = files["mass_matrix"], files["stiffness_matrix"], files["node_table"]
    if table is None or nodes_file is None or mass is None or stiffness is None:
        return VsdfBody(record.subject, **pose)
    nodes = dict(zip(map(int, table.numbers), table.positions, strict=True))
    sets = sets_of(values, k, nodes, findings)
    interfaces = interface_nodes(values, k, nodes, sets, nodes_file, findings)
    nodes |= {one.node: one.position for one in interfaces}
    given = FlexibleInput(
        record.subject,
        mass,
        stiffness,
        table.numbers,
        table.positions,
        files["mapping"],
        _reference(record, nodes, k, findings),
        **_node_lists(values, k, nodes, sets, findings),
        **changes_of_matrices(values, k, table.numbers.tolist(), findings),
        modes=_modes(record, findings),
        damping=_damping(values.record("damping", k), findings),
        unit_loads=_unit_loads(values, k, folder, names.get("unit_load", ""), findings),
        stiffening=stiffening_material(values, k, nodes_file, findings),
        material=stress_material(values, k, nodes_file, findings),
        place=record.place,
        mesh=mesh_file(values, k, nodes_file),
        ratios=_ratios(values, k, findings),
        interfaces=interfaces,
        damping_matrix=files["damping_matrix"],
        axes=None if mass.form in (OF_ELEMENTS, OF_STRUCTURES) else table.axes,
    )
    stiffened = _stiffened(values.record("stiffening", k), given, findings)
    arms = arms_of(values, k, nodes, sets, findings) | carrying_arms(interfaces, nodes)
    check_uses(k, given, sets, findings)
    return VsdfBody(
        record.subject, **pose, flexible=given, nodes=nodes, sets=sets, arms=arms, stiffened=stiffened
    )


def _files(
    values: DeckValues, k: int, record: Record, folder: Path, names: dict[str, str], findings: Findings
) -> dict[str, Any]:
    """Return the files of body k by their sections, None of those that the deck does not name."""
    files = {name: _file(values.record(name, k), folder, names.get(name, "")) for name in _FILES}
    files |= matrices_of_elements(values, k, files)
    for name, word in _MATRICES.items():
        if files[name] is None:
            message = f"a FLEX body needs a card {word}{_or_density(values, k, files)}"
            findings.error(record.subject, message, record.place, id="VSDF-023")
    _check_mapping(values.record("mapping", k), files, findings)
    return files


def _or_density(values: DeckValues, k: int, files: Any) -> str:
    """Return what else helps where both matrices are missing."""
    if values.record("material", k) and files["mass_matrix"] is files["stiffness_matrix"] is None:
        return ", or the density of its elements on MATL"
    return ""


def _matrix_names(values: DeckValues, k: int, findings: Findings) -> dict[str, str]:
    """Return the names of matrices by the sections of the files that hold them."""
    names: dict[str, str] = {}
    for record in values.of_body("matrix_name", k):
        which = record.at("which")
        section = MATRIX_SECTIONS[which.value]
        if section in names:
            message = f"matrix {which.value} of body {k} has a name already"
            findings.error(record.subject, message, which.place, id="VSDF-190")
        if not values.places_of_body(section, k):
            message = f"body {k} has no card {_WORDS[section]}, whose matrix it could name"
            findings.error(record.subject, message, which.place, id="VSDF-191")
        names[section] = record["name"]
    return names


def _file(record: Record | None, folder: Path, matrix: str = "") -> FEFile | None:
    return None if record is None else _file_of(record, folder, matrix)


def _file_of(record: Record, folder: Path, matrix: str = "") -> FEFile:
    path = folder / record["file"].replace("\\", "/")
    return FEFile(path, record["form"], record.at("file").place, matrix)


def _check_mapping(record: Record | None, files: "dict[Any, Any]", findings: Findings) -> None:
    """Matrices whose rows have nodes and directions need no mapping."""
    forms = {files[name].form for name in ("mass_matrix", "stiffness_matrix") if files[name]}
    if record and forms and not forms & set(TAKES_MAPPING):
        which = ", ".join(TAKES_MAPPING)
        message = f"the mapping is not read: only matrices of formats {which} have one; remove the card"
        findings.error(record.subject, message, record.place, id="VSDF-024")


def _check_shapes(values: DeckValues, k: int, findings: Findings) -> None:
    """The interface nodes of Craig and Bampton's method have their static shapes; no others are added."""
    if values.places_of_body("interface", k):
        for record in values.of_body("attachment", k):
            message = f"ATTM is not read beside CRBN of body {k}; name its nodes on CRBN, or remove CRBN"
            findings.error(record.subject, message, record.place, id="VSDF-025")


def _node_table(
    values: DeckValues, k: int, record: Record, folder: Path, findings: Findings
) -> NodeTable | None:
    given = _file(values.record("node_table", k), folder)
    if given is None:
        findings.error(record.subject, "a FLEX body needs a card FEMN", record.place, id="VSDF-026")
        return None
    try:
        return read_node_table(given.path, given.form)
    except FEFileFault as fault:
        findings.error(record.subject, str(fault), given.place, id=fault.id)
        return None


def _reference(record: Record, nodes: "dict[int, np.ndarray]", k: int, findings: Findings) -> tuple[int, ...]:
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
            findings.error(record.subject, message, number.place, id="VSDF-027")
    values = tuple(number.value for number in numbers)
    if len(set(values)) < 3 and 0 not in values:
        message = "the three reference nodes must differ"
        findings.error(record.subject, message, numbers[0].place, id="VSDF-028")
        return ()
    return values if all(value in nodes for value in values) else ()


def _modes(record: Record, findings: Findings) -> int:
    number = record.at("modes")
    if number.value < 0:
        message = f"a number of modes is 0 or more; read {number.text}"
        findings.error(record.subject, message, number.place, id="VSDF-029")
        return 0
    return int(number.value)


def _node_lists(
    values: DeckValues, k: int, nodes: "dict[int, np.ndarray]", sets: Any, findings: Findings
) -> "dict[Any, Any]":
    """Nodes that the cards CLMP, ATTM, CRBN name, sets taken apart."""
    known = {**{number: (number,) for number in nodes}, **sets}
    lists = {}
    for section in _LISTS:
        members = []
        for record in values.of_body(section, k):
            members += [n for m in members_of(record, known, k, findings) for n in known[m]]
        lists[section] = tuple(dict.fromkeys(members))
    return lists


def _damping(record: Record | None, findings: Findings) -> Any:
    if record is None:
        return 0.0, 0.0, 0.0
    for key in ("alpha", "beta", "ratio"):
        if record[key] < 0:
            message = f"{key} = {record.at(key).text}: negative damping feeds energy in"
            findings.error(record.subject, message, record.at(key).place, id="VSDF-030")
    return tuple(float(record[key]) for key in ("alpha", "beta", "ratio"))


def _ratios(values: DeckValues, k: int, findings: Findings) -> tuple[tuple[float, float], ...]:
    """Frequencies, ascending, and damping ratios of the cards DAMF, which replace the ratio of DAMP."""
    of_frequency: dict[float, float] = {}
    for record in values.of_body("damping_table", k):
        frequency, ratio = record.at("f"), record.at("ratio")
        if ratio.value < 0:
            message = f"ratio = {ratio.text}: negative damping feeds energy in"
            findings.error(record.subject, message, ratio.place, id="VSDF-221")
        if frequency.value < 0 or float(frequency.value) in of_frequency:
            message = f"frequencies are 0 or more, each given once; read {frequency.text}"
            findings.error(record.subject, message, frequency.place, id="VSDF-222")
        of_frequency[float(frequency.value)] = float(ratio.value)
    damping = values.record("damping", k)
    if of_frequency and damping and damping["ratio"]:
        message = "the ratio is not read beside the cards DAMF of the body; leave it empty"
        findings.error(damping.subject, message, damping.at("ratio").place, id="VSDF-223")
    return tuple(sorted(of_frequency.items()))


def _unit_loads(
    values: DeckValues, k: int, folder: Path, matrix: str, findings: Findings
) -> tuple[UnitLoad, ...]:
    loads: list[UnitLoad] = []
    for record in values.of_body("unit_load", k):
        number = record.at("load")
        if not 4 <= number.value <= 12:
            message = f"unit load {number.value}: only 4 to 12 (xx xy xz yx yy yz zx zy zz) are used"
            findings.error(record.subject, message, number.place, id="VSDF-031")
            continue
        i, j = divmod(number.value - 4, 3)
        if any((load.i, load.j) == (i, j) for load in loads):
            message = f"unit load {number.value} is given twice"
            findings.error(record.subject, message, number.place, id="VSDF-032")
        loads.append(UnitLoad(i, j, _file_of(record, folder, matrix)))
    return tuple(loads)


def _stiffened(record: Record | None, given: FlexibleInput, findings: Findings) -> bool:
    if record and record["on"] not in (0, 1):
        message = f"on is 0 or 1; read {record.at('on').text}"
        findings.error(record.subject, message, record.at("on").place, id="VSDF-035")
    if record is None or not record["on"]:
        if given.unit_loads:
            message = f"FEMG is not used: GEOS does not switch stiffening on for {given.name}"
            findings.warn(given.name, message, given.unit_loads[0].file.place, id="VSDF-036")
        return False
    if given.unit_loads and given.stiffening:
        message = "stiffening comes either from the matrices of FEMG or from elements; leave E out, or FEMG"
        findings.error(record.subject, message, record.at("E").place, id="VSDF-037")
    if not given.unit_loads and not given.stiffening:
        message = (
            "centrifugal stiffening needs geometric stiffness matrices, cards FEMG, or E and nu of the "
            "elements in the node table's file, on GEOS or on MATL"
        )
        findings.error(record.subject, message, record.at("on").place, id="VSDF-038")
    return True
