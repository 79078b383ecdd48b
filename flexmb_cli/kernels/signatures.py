"""What Python calls of the kernels, and with which arguments: data, from which all of them can be compiled.

A unit is what one analysis needs, and one file of machine code.  Words: f2 is an array of floats of two
dimensions (i: integers, c: complex, b: truth values); CONSTRAINT1 one of records; `int`, `float`, `bool` are
numbers; the others are named tuples of TUPLES.
"""

import functools
import importlib

# Processor and system → what LLVM calls it, and the oldest processor of that kind: no fused multiply-add.
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
    "CONSTRAINT": "model.arrays:CONSTRAINT",
    **{name: f"model.system_records:{name}" for name in ("MASS", "FLEXIBLE", "ARM", "MEASURE", "LOAD")},
    "LAW": "model.system_records:LAW",
    "GROUP": "model.system_records:GROUP",
    "FRAME": "model.tree_frames:FRAME",
    "LUMP": "model.tree_frames:LUMP",
    **{name: f"model.tree_arrays:{name}" for name in ("ELASTIC_BODY", "SPRING", "PRESCRIBED", "CLOSURE_ROW")},
    "TREE_LAW": "model.tree_arrays:LAW",
    "RIDER": "model.tree_riders:RIDER",
    "RIDDEN_BODY": "model.tree_riders:RIDDEN_BODY",
    "FRAME_WORK": "kernels.tree_work:FRAME_WORK",
    "COORDINATE_WORK": "kernels.tree_work:COORDINATE_WORK",
    "TREE_CLOCK": "kernels.tree_march:CLOCK",
    "MEMORY": "kernels.implicit_march:MEMORY",
    "CLOCK": "kernels.constrained_march:CLOCK",
    "ALPHA_CLOCK": "kernels.alpha_march:CLOCK",
    "RADAU_CLOCK": "kernels.radau_march:CLOCK",
}
TUPLES = {
    "Mechanism": ("kernels.newton:System", "CONSTRAINT1 i2 f2 f1"),
    "Newton": ("kernels.newton:Work", "f4 f2 f2 f2 i1 i2"),
    "System": (
        "kernels.constrained_system:System",
        "CONSTRAINT1 i2 f1 f1 MASS1 FLEXIBLE1 f1 ARM1 f1 MEASURE1 LOAD1 LAW1 f2 f1 GROUP1",
    ),
    "Work": ("kernels.constrained_system:Work", "f4 f2 f2 f2 f2 f2 i1 f2 f2 f3 f1 f3 f4 f1 f2 i1 f1 f1"),
    "Inertia": ("kernels.mass_matrix:Inertia", "MASS1 FLEXIBLE1 f3 f1"),
    "Report": ("kernels.constrained_report:Report", "f1 f2 f2 f4 f2 f1 f2"),
    "March": ("kernels.constrained_march:March", "CLOCK1 f1 f1 f1 f2 f2 f1 f2"),
    "AlphaMarch": (
        "kernels.alpha_march:AlphaMarch", "ALPHA_CLOCK1 f1 f1 f1 f1 f2 f2 f1 f1 f1 f2 Work",
    ),
    "RadauMarch": (
        "kernels.radau_march:RadauMarch",
        "RADAU_CLOCK1 f1 f1 f1 f1 f2 f2 f2 f2 f2 f2 f2 f1 f1 f2 f3 f3 c2 f1 c1 Work",
    ),
    "Tree": (
        "model.tree_arrays:TreeArrays",
        "FRAME1 LUMP1 ELASTIC_BODY1 f1 f1 f1 i2 SPRING1 PRESCRIBED1 TREE_LAW1 CLOSURE_ROW1 f2 f1 b1 b1 f1 "
        "Riders bool",
    ),
    "Riders": ("model.tree_riders:Riders", "RIDER1 RIDDEN_BODY1 f1 f2 f2 f1 f2 f2 f2 f2 f2 f1 f1"),
    "TreeMarch": ("kernels.tree_march:March", "TREE_CLOCK1 f1 f1 f1 f2 f2"),
    "TreeReport": ("kernels.tree_march:Report", "f1 f2 FRAME_WORK2 f2 CLOSURE_ROW2 f2"),
    "Implicit": ("kernels.implicit_march:Implicit", "MEMORY1 f2 f1 f1 f1 f1 f1 f1 f1 f1 Stiff"),
    "Stiff": ("kernels.tree_jacobian:Stiff", "f2 f2 f2 i1 i1 i1 f1 CLOSURE_ROW1 f2 f2 f2"),
}  # fmt: skip

UNITS = {
    "equations": {
        "constraints.residual": "CONSTRAINT1 f1 float f1 f3 f1",
        "constraints.jacobian": "CONSTRAINT1 f1 f3 f2",
        "constraints.velocity": "CONSTRAINT1 float f1",
        "constraints.acceleration": "CONSTRAINT1 f1 f1 float f4 f1",
        "rotation.rotation_matrices": "f1 f3",
        "rotation.rotation_rates": "f1 f1 f3 f3",
    },
    "kinematics": {
        "kinematic_march.march": "Mechanism f2 f2 f1 f1 f3 f2",
        "newton.evaluate_position": "Mechanism Newton f1 float f1",
        "newton.reach_of": "Mechanism f1",
        "kinematic_march.predict": "f2 float f1",
        "kinematic_march.screws_expected": "f2 float f1",
        "kinematic_march.defect": "Mechanism f2 f2 float",
        "kinematic_march.step_to": "f1 float",
        "kinematic_march.turns_too_far": "CONSTRAINT1 float float",
        "kinematic_march.acceptable": "f1 float float int",
        "kinematic_march.accept": "Mechanism Newton f2 f1 f2 f2",
        "kinematic_march.after_success": "f1 float float int",
        "kinematic_march.is_barred": "f1 float",
    },
    "constrained": {
        "constrained_solve.evaluate_jacobian": "System Work f1",
        "constrained_solve.choose_order": "Work int",
        "constrained_solve.accelerations": "System Work f1 f1 float f1",
        "constraint_projection.evaluate_residual": "System Work f1 float f1",
        "constraint_projection.fill_nu": "System float f1",
        "constraint_projection.project_position": "System Work f1 float f1",
        "constraint_projection.project_speeds": "System Work f1 f1 float",
        "mass_matrix.mass_times": "Inertia f1 f1",
        "screw_turns.fill_angles": "System Work f1 f1 f1",
        "speeds.move": "int f1 f1",
        "speeds.normalise": "int f1",
        "constrained_report.observe_rows": "System Work f2 Report",
    },
    "explicit": {"constrained_march.march_rows": "int System Work March Report int"},
    "alpha": {"alpha_march.march_rows": "int System Work AlphaMarch Report int"},
    "radau": {"radau_march.march_rows": "int System Work RadauMarch Report int"},
    "trees": {
        "tree_march.call": "int int Tree FRAME_WORK1 COORDINATE_WORK1 TreeMarch TreeReport",
        "tree_motion.derivative": "Tree FRAME_WORK1 COORDINATE_WORK1 float f1 f1",
        "tree_motion.normalise_attitudes": "Tree f1",
        "tree_motion.turn_attitudes": "Tree f1 f2 f2",
        "tree_projection.measure": "Tree FRAME_WORK1 COORDINATE_WORK1 f1",
    },
    "implicit_trees": {
        "implicit_march.march_implicitly": (
            "float int Tree FRAME_WORK1 COORDINATE_WORK1 TREE_CLOCK1 f1 Implicit"
        ),
        "implicit_march.between": "float float f1 Implicit f1",
    },
}
_KINDS = {"f": "<f8", "i": "<i8", "c": "<c16", "b": "|b1"}
_NUMBERS = {"int": "i", "float": "f", "bool": "b"}
_UNIT_OF = {name: unit for unit, entries in UNITS.items() for name in entries}


def unit_of(name: str) -> str | None:
    """Return the unit of an entry, None for a kernel that only tests call."""
    return _UNIT_OF.get(name)


def unit_parameters(unit: str) -> dict[str, list]:
    """Return the parameters of all entries of a unit, as `_arguments` describes them."""
    return {name: [parameter(word) for word in words.split()] for name, words in UNITS[unit].items()}


@functools.cache
def parameter(word: str) -> "str | list":
    """Return the parameter for a word of this page."""
    if word in _NUMBERS:
        return _NUMBERS[word]
    if word in TUPLES:
        place, words = TUPLES[word]
        return ["t", f"flexmb_cli.{place}", [parameter(part) for part in words.split()]]
    kind, dimensions = word[:-1], int(word[-1])
    return ["a", dimensions, _KINDS[kind] if kind in _KINDS else _record(kind)]


def _record(name):
    """The fields of a record; its module may import kernels, so that it is found when it is needed."""
    module, _, constant = RECORDS[name].partition(":")
    return getattr(importlib.import_module(f"flexmb_cli.{module}"), constant).descr
