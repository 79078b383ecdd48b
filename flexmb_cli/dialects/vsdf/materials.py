"""The material of a flexible body's elements: on GEOS for its stiffening, on MATL for its stresses."""

import math
from dataclasses import replace
from typing import Any

from ...deck.record import Record
from ...deck.records import DeckValues
from ...fe.formats.formats import FORMS_WITH_ELEMENTS, OF_ELEMENTS
from ...model.diagnostics import Findings
from ...model.flexible_body import ElementMaterial, FEFile


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
    elements = FEFile(table.path, OF_ELEMENTS, record.place)
    return {"mass_matrix": elements, "stiffness_matrix": elements}


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
    found = _material(record, file, findings, float(density.value) if density.text else math.nan)
    return found if types is None else _of_types(values, k, types, found, findings)


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
