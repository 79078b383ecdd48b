"""Lines MASS: points and solids, whose masses are added to those that cards give the bodies."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from ...fe.formats.matrix_file import FEFileFault
from ...fe.formats.stl import read_stl
from ...fe.solid_masses import of_mass, placed, point_mass, polyhedron_mass, primitive_mass, surface_fault
from ...model.diagnostics import Findings, no_such
from ...model.fe_model import RigidMass
from ...model.shapes import fault_of_sizes
from .line import ElementLine, mass_lines
from .words import POINT, STL


def added_masses(
    lines: Iterable[ElementLine], rigid: Sequence[bool], folder: Path, findings: Findings
) -> dict[int, list[RigidMass]]:
    """Return the masses of lines by bodies, counted from 0, in body axes; faults go into `findings`.

    `rigid`: of the bodies; file names are relative to `folder`.
    """
    of_body: dict[int, list[RigidMass]] = {}
    for line in mass_lines(lines):
        body = line.at("body")
        if not 1 <= body.value <= len(rigid):
            message = no_such("body", body.value, len(rigid))
            findings.error(line.subject, message, line.place_of("body"), id="ELEMENTS-183")
        elif not rigid[body.value - 1]:
            message = f"body {body.value} is flexible: its nodes carry its mass; add it there (NODM of VSDF)"
            findings.error(line.subject, message, line.place_of("body"), id="ELEMENTS-184")
        elif (solid := _solid(line, folder, findings)) is not None:
            of_body.setdefault(body.value - 1, []).append(solid)
    return of_body


def _solid(line: ElementLine, folder: Path, findings: Findings) -> RigidMass | None:
    """Return the mass of a line; None with a fault noted."""
    given = "mass" if "mass" in line else "density"
    if not line[given] > 0:
        message = f"{given} must be above 0; read {line[given]:g}"
        findings.error(line.subject, message, line.place_of(given), id="ELEMENTS-185")
        return None
    if line.kind == POINT:
        return point_mass(float(line["mass"]), line.vector("centre"))
    solid = _surface(line, folder, findings) if line.kind == STL else _primitive(line, findings)
    if solid is None:
        return None
    factor = float(line["density"]) if given == "density" else float(line["mass"]) / solid.mass
    return placed(of_mass(solid, factor), line.vector("centre"), line.vector("angles"))


def _primitive(line: ElementLine, findings: Findings) -> RigidMass | None:
    sizes = line.vector("size")
    if wrong := fault_of_sizes(line.kind, sizes):
        key = f"size.{'xyz'[wrong[0]]}"
        message = f"{key} of a {line.kind} {wrong[1].replace('leave the field empty', 'write 0')}"
        findings.error(line.subject, message, line.place_of(key), id="ELEMENTS-186")
        return None
    return primitive_mass(line.kind, sizes)


def _surface(line: ElementLine, folder: Path, findings: Findings) -> RigidMass | None:
    if not line["unit"] > 0:
        message = f"the unit must be above 0, 0.001 for a file in mm; read {line['unit']:g}"
        findings.error(line.subject, message, line.place_of("unit"), id="ELEMENTS-187")
        return None
    name = line.at("file")
    try:
        vertices, triangles = read_stl(folder / name.value.replace("\\", "/"))
    except FEFileFault as fault:
        findings.error(line.subject, str(fault), line.place_of("file"), id=fault.id)
        return None
    vertices = np.asarray(line["unit"] * vertices, float)
    if wrong := surface_fault(vertices, triangles):
        findings.error(
            line.subject, f"the surface in {name.value} {wrong}", line.place_of("file"), id="ELEMENTS-188"
        )
        return None
    return polyhedron_mass(vertices, triangles)
