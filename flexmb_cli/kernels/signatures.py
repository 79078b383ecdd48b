"""Kernels that Python calls, and their argument types: data, from which all of them can be compiled.

A unit is what one analysis needs, and one file of machine code.  Words: f2 is an array of floats of two
dimensions (i: integers, c: complex, b: truth values); CONSTRAINT1 one of records; `int`, `float`, `bool` are
numbers; the others are named tuples of TUPLES.
"""

import functools
import importlib
from typing import Any

import numpy as np

from ._arguments import Array, Fields

# Processor and system → what LLVM calls it, and the oldest processor of that type: no fused multiply-add.
PROCESSORS = {
    "x86_64-linux": ("x86_64-unknown-linux-gnu", "x86-64"),
    "arm64-linux": ("aarch64-unknown-linux-gnu", "generic"),
    "x86_64-macos": ("x86_64-apple-macosx10.13.0", "x86-64"),
    "arm64-macos": ("arm64-apple-macosx11.0.0", "generic"),
    "x86_64-windows": ("x86_64-pc-windows-msvc", "x86-64"),
    "arm64-windows": ("aarch64-pc-windows-msvc", "generic"),
}

# Where records are defined.
RECORDS = {
    "CONSTRAINT": "model.arrays.kinematic:CONSTRAINT",
    **{
        name: f"model.arrays.records:{name}"
        for name in ("MASS", "FLEXIBLE", "BODY_VECTOR", "PRIMITIVE", "LOAD")
    },
    "FUNCTION": "model.arrays.records:FUNCTION",
    "LAW": "model.arrays.records:LAW",  # part of other records
    "GROUP": "model.arrays.records:GROUP",
    **{name: f"model.arrays.contacts:{name}" for name in ("CONTACT_SET", "END", "TOUCH", "KEPT")},
    "MESH_BOX": "model.arrays.meshes:MESH_BOX",
    "FRAME": "model.arrays.tree_frames:FRAME",
    "NODAL_MASS": "model.arrays.tree_frames:NODAL_MASS",
    **{name: f"model.arrays.tree:{name}" for name in ("ELASTIC_BODY", "PRESCRIBED", "CLOSURE_ROW")},
    "TREE_TORQUE": "model.arrays.tree:TORQUE",
    "TREE_ELEMENT": "model.arrays.tree_elements:TREE_ELEMENT",
    "SIGNAL": "model.arrays.signals:SIGNAL",
    "TREE_FRICTION": "model.arrays.tree_elements:TREE_FRICTION",
    "NODE_FRAME": "model.arrays.node_frames:NODE_FRAME",
    "FLEXIBLE_PARENT": "model.arrays.node_frames:FLEXIBLE_PARENT",
    "FRAME_WORK": "kernels.tree.work:FRAME_WORK",
    "COORDINATE_WORK": "kernels.tree.work:COORDINATE_WORK",
    "CLOCK": "kernels.integrators.clock:CLOCK",
    "SDIRK_MEMORY": "kernels.integrators.sdirk4:MEMORY",
    "ALPHA_MEMORY": "kernels.integrators.generalised_alpha:MEMORY",
    "RADAU_MEMORY": "kernels.integrators.radau5:MEMORY",
}
TUPLES = {
    "Mechanism": ("kernels.kinematics.newton:System", "CONSTRAINT1 i2 f2 f1"),
    "SparseNewton": (
        "kernels.kinematics.newton:SparseWork", "f4 f2 f2 f2 i2 i2 i1 f1 i1 i2 f1 f1",
    ),
    "Newton": ("kernels.kinematics.newton:Work", "f4 f2 f2 f2 i1 i2"),
    "System": (
        "kernels.constrained.system:System",
        "CONSTRAINT1 i2 f1 f1 MASS1 FLEXIBLE1 f1 BODY_VECTOR1 f1 PRIMITIVE1 LOAD1 LOAD1 Signals "
        "FUNCTION1 f2 f1 GROUP1 BODY_VECTOR1 PRIMITIVE1 Contacts",
    ),
    "Work": (
        "kernels.constrained.system:Work",
        "f4 f2 f2 f2 f1 i1 f2 f2 f3 f1 f3 f4 f1 f2 i1 f1 f1 f2 i2 i1 i2 f1 f2 f3 f4",
    ),
    "Report": ("kernels.constrained.report:Report", "f1 f2 f2 f4 f2 f1 f2 f3 f3 f2"),
    "Integration": ("kernels.integrators.integrations:Integration", "CLOCK1 f1 f1 f1 f2 f2 f1 f2"),
    "AlphaIntegration": (
        "kernels.integrators.integrations:AlphaIntegration",
        "CLOCK1 ALPHA_MEMORY1 f1 f1 f1 f1 f2 f2 f2 f2 f2 f2 f2 Work f2",
    ),
    "RadauIntegration": (
        "kernels.integrators.integrations:RadauIntegration",
        "CLOCK1 RADAU_MEMORY1 f1 f1 f1 f1 f2 f2 f2 f2 f2 f2 f2 f1 f1 f2 f2 f3 f3 c2 f1 c1 Work f2 f2",
    ),
    "Tree": (
        "model.arrays.tree:TreeArrays",
        "FRAME1 NODAL_MASS1 ELASTIC_BODY1 f1 f1 f1 i2 PRESCRIBED1 TREE_TORQUE1 CLOSURE_ROW1 f2 f2 "
        "f2 f2 f1 b1 b1 f1 NodeFrames TREE_ELEMENT1 TREE_FRICTION1 f3 f1 f2 TREE_ELEMENT1 Signals FUNCTION1 "
        "f2 Contacts int bool",
    ),
    "Contacts": ("model.arrays.contacts:Contacts", "CONTACT_SET1 END1 TOUCH1 KEPT1 i1 i2 MESH_BOX1 f2"),
    "Signals": ("model.arrays.signals:Signals", "SIGNAL1 i1 i1 f1 f2 f1 f1 f1 f1 f2"),
    "NodeFrames": (
        "model.arrays.node_frames:NodeFrames",
        "NODE_FRAME1 FLEXIBLE_PARENT1 f1 f2 f2 f1 f2 f2 f2 f2 f2 f1 f1",
    ),
    "TreeIntegration": ("kernels.integrators.tree_dop853:Integration", "CLOCK1 f1 f1 f1 f2 f2 f1"),
    "TreeReport": ("kernels.tree.report:Report", "f1 f2 FRAME_WORK2 f2 CLOSURE_ROW2 f2 f3 f2 f2 f3"),
    "Implicit": (
        "kernels.integrators.sdirk4:Implicit", "CLOCK1 f1 SDIRK_MEMORY1 f2 f1 f1 f1 f1 f1 f1 f1 f1 Stiff",
    ),
    "Stiff": ("kernels.tree.implicit_matrix:Stiff", "f2 f2 f2 i1 i1 i1 f1 CLOSURE_ROW1 f2 f2 f2 f2 f2"),
}  # fmt: skip

UNITS = {
    "equations": {
        "kinematics.constraints.residual": "CONSTRAINT1 f1 float f1 f3 f1",
        "kinematics.constraints.jacobian": "CONSTRAINT1 f1 f3 f2",
        "kinematics.constraints.velocity": "CONSTRAINT1 float f1",
        "kinematics.constraints.acceleration": "CONSTRAINT1 f1 f1 float f4 f1",
        "linalg.rotation.rotation_matrices": "f1 f3",
        "linalg.rotation.rotation_rates": "f1 f1 f3 f3",
    },
    "kinematics": {
        "kinematics.continuation.follow": "Mechanism f2 f2 f1 f1 f3 f2",
        "kinematics.newton.evaluate_position": "Mechanism Newton f1 float f1",
        "kinematics.newton.defects_of_rows": "Mechanism Newton f3 f1 int f1 f2",
        "kinematics.variants.follow_variants": "Mechanism i1 f3 f1 f1 float f1 f4 f3 b1",
    },
    "large_kinematics": {"kinematics.continuation.follow_sparse": "Mechanism SparseNewton f2 f2 f1 f1 f3 f2"},
    "constrained": {
        "constrained.accelerations.evaluate_jacobian": "System Work f1",
        "constrained.accelerations.choose_order": "Work int",
        "constrained.accelerations.factorise_order": "Work",
        "linalg.local_order.choose_local": "i1 i2 f2 i1 int",
        "constrained.accelerations.accelerations": "System Work f1 f1 float f1",
        "constrained.projection.evaluate_residual": "System Work f1 float f1",
        "constrained.projection.fill_nu": "System float f1",
        "constrained.projection.project_position": "System Work f1 float f1",
        "constrained.projection.project_speeds": "System Work f1 f1 float",
        "constrained.projection.rate_gap": "System Work f1 float",
        "constrained.mass_matrix.mass_matrices": "System Work f1",
        "constrained.mass_matrix.mass_times": "System Work f1 f1",
        "constrained.dry_friction.fill_normal_forces": "f3 f1",
        "constrained.angle_unwrapping.fill_angles": "System Work f1 f1 f1",
        "constrained.speeds.move": "int f1 f1",
        "constrained.speeds.normalise": "int f1",
        "constrained.report.observe_rows": "System Work f2 Report",
    },
    "explicit": {"integrators.constrained_dop853.integrate_rows": "int System Work Integration Report int"},
    "alpha": {"integrators.generalised_alpha.integrate_rows": "int System Work AlphaIntegration Report int"},
    "radau": {"integrators.radau5.integrate_rows": "int System Work RadauIntegration Report int"},
    "trees": {
        "integrators.tree_dop853.begin": "int Tree FRAME_WORK1 COORDINATE_WORK1 TreeIntegration",
        "integrators.tree_dop853.integrate_rows": (
            "Tree FRAME_WORK1 COORDINATE_WORK1 TreeIntegration TreeReport int"
        ),
        "tree.motion.derivative": "Tree FRAME_WORK1 COORDINATE_WORK1 float f1 f1",
        "tree.loads.set_prescribed": "Tree float f1 f1 COORDINATE_WORK1",
        "tree.motion.normalise_attitudes": "Tree f1",
        "tree.motion.turn_attitudes": "Tree f1 f2 f2",
        "tree.projection.evaluate_gaps": "Tree FRAME_WORK1 COORDINATE_WORK1 f1",
    },
    "implicit_trees": {
        "integrators.sdirk4.integrate_rows": "Tree FRAME_WORK1 COORDINATE_WORK1 Implicit TreeReport int"
    },
    "tree_masses": {"tree.composite_mass.set_mass": "Tree FRAME_WORK1 COORDINATE_WORK1 f1 f2"},
}
_KINDS = {
    letter: np.dtype(kind) for letter, kind in zip("ficb", (float, np.int64, complex, bool), strict=True)
}
_NUMBERS = {"int": "i", "float": "f", "bool": "b"}
_UNIT_OF = {name: unit for unit, entries in UNITS.items() for name in entries}


def unit_of(name: str) -> str | None:
    """Return the unit of an entry, None for a kernel that only tests call."""
    return _UNIT_OF.get(name)


def unit_parameters(unit: str) -> dict[str, list]:
    """Return the parameters of all entries of a unit, as `_arguments` describes them."""
    return {name: [parameter(word) for word in words.split()] for name, words in UNITS[unit].items()}


@functools.cache
def parameter(word: str) -> Any:
    """Return the parameter for a word of this page."""
    if word in _NUMBERS:
        return _NUMBERS[word]
    if word in TUPLES:
        place, words = TUPLES[word]
        return Fields(_defined(place), [parameter(part) for part in words.split()])
    kind, dimensions = word[:-1], int(word[-1])
    return Array(dimensions, _KINDS[kind] if kind in _KINDS else _defined(RECORDS[kind]))


def _defined(place: str) -> Any:
    """Return the object defined at a place; its module may import kernels, so that it is imported late."""
    module, _, name = place.partition(":")
    return getattr(importlib.import_module(f"flexmb_cli.{module}"), name)
