"""Flexible bodies: reduced from the files of a finite-element program, and kept on disk.

They are kept under the hash of what they are made of: files, settings, layout.  Files of the cache appear
whole or not at all, hold plain arrays and text (no pickle), and one that cannot be read is made anew.  They
are notes and arrays of numpy's one after the other: archives need modules that take longer to import than
all the rest to read.
"""

import hashlib
import io
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import Fault, ModelError
from ..managed_files import UnsafePlace, is_own, make_own_folder, open_managed
from ..model.diagnostics import Findings
from ..model.flexible_body import BodyMesh, BodyStress, Dropped, ElementMaterial, FlexibleBody, FlexibleInput
from .formats.formats import content_of
from .formats.matrix_file import FEFileFault
from .interface_nodes import own_input, with_interface_nodes

# To be raised when the arrays, or how they are computed, change.
LAYOUT = 18
# Bytes after the arrays: a damage anywhere makes the body anew, instead of another body.
DIGEST = 32
_VARIABLES = (("FLEXMB_CACHE_DIR", ""), ("XDG_CACHE_HOME", ""), ("LOCALAPPDATA", ""), ("HOME", ".cache"))
_ENDING = ".body"
_ARRAYS = tuple(
    item.name for item in fields(FlexibleBody) if item.name not in ("name", "dropped", "stress", "mesh")
)
_MESH = tuple(item.name for item in fields(BodyMesh))
_STRESS = tuple(item.name for item in fields(BodyStress))


def cache_folder() -> Path | None:
    """The folder of the cache, None when no variable of the environment names one that can be written."""
    for variable, below in _VARIABLES:
        base = os.environ.get(variable)
        if not base:
            continue
        folder = Path(base) / below / "flexmb" / "bodies"
        try:
            make_own_folder(folder)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    return None


def key_of(given: FlexibleInput) -> str:
    """Name of everything the body depends on.  Raises OSError when a file cannot be read."""
    digest = hashlib.sha256(f"flexmb body {LAYOUT}".encode())
    files = [
        given.mass,
        given.stiffness,
        given.mapping,
        given.mesh,
        *(load.file for load in given.unit_loads),
    ]
    files += [given.damping_matrix] * (given.damping_matrix is not None)
    files += [material.file for material in (given.stiffening, given.material) if material]
    for file in files:
        digest.update(f"|{file.form}{file.matrix and ' ' + file.matrix}".encode() if file else b"|none")
        if file:
            digest.update(hashlib.sha256(_content(file)).digest())
    digest.update(np.ascontiguousarray(given.numbers, dtype="<i8").tobytes())
    digest.update(np.ascontiguousarray(given.positions, dtype="<f8").tobytes())
    for array in _further_arrays(given):
        digest.update(np.ascontiguousarray(array, dtype="<f8").tobytes())
    digest.update(_settings(given).encode())
    return digest.hexdigest()


def _further_arrays(given: FlexibleInput) -> Iterator[np.ndarray]:
    """Yield displacement axes and interface nodes, which few bodies have."""
    if given.axes is not None:
        yield given.axes
    for one in given.interfaces:
        yield np.array([one.node, *one.position, one.rigid, one.turns, *one.members, *one.weights])


def _content(file: Any) -> bytes:
    """Return what a file holds, and those that it includes.  Raises OSError."""
    try:
        return content_of(file.path, file.form)
    except FEFileFault as fault:
        raise OSError(str(fault)) from fault


def _settings(given: FlexibleInput) -> str:
    loads = [(load.i, load.j) for load in given.unit_loads]
    settings: tuple[Any, ...] = (
        given.reference,
        given.clamped,
        given.attachment,
        given.interface,
        given.modes,
        tuple(float(value).hex() for value in given.damping),
        given.ratios,
        loads,
        given.stiffening and (given.stiffening.young.hex(), given.stiffening.poisson.hex()),
    )
    if given.nodal_masses or given.stiffness_factor != 1.0:
        settings = (*settings, given.nodal_masses, given.stiffness_factor)
    return repr((*settings, "stress", _of_material(given.material)) if given.material else settings)


def _of_material(material: ElementMaterial) -> tuple[object, ...]:
    numbers = (material.young.hex(), material.poisson.hex(), material.density.hex())
    return *numbers, material.program, material.lumped, material.any_stiffness


def load(given: FlexibleInput) -> tuple[FlexibleBody, list[Fault]] | None:
    """The body and the warnings that were noted when it was made; None when it is not in the cache."""
    folder = cache_folder()
    if folder is None:
        return None
    try:
        key = key_of(given)
        with open(open_managed(str(folder / f"{key}{_ENDING}"), os.O_RDONLY), "rb") as stream:
            # Numbers of another user would be taken for those of the deck's files, without a word.
            raw = stream.read() if is_own(os.fstat(stream.fileno())) else b""
    except (OSError, UnsafePlace):
        return None
    content, digest = raw[:-DIGEST], raw[-DIGEST:]
    if _digest(key, content) != digest:
        return None
    arrays = io.BytesIO(content)
    try:
        notes = json.loads(str(np.load(arrays, allow_pickle=False)))
        stored = {name: np.load(arrays, allow_pickle=False) for name in notes["arrays"]}
        return _restored(given, notes, stored)
    except (ValueError, KeyError, TypeError, AttributeError, EOFError):
        return None  # whole, but no body of this layout


def _digest(key: str, content: bytes) -> bytes:
    """Digest of a body's file; who may rename it does not make it another body."""
    return hashlib.sha256(key.encode() + content).digest()


def _restored(given: FlexibleInput, notes: dict[Any, Any], stored: Any) -> tuple[FlexibleBody, Any]:
    arrays = {name: stored[name] for name in _ARRAYS}
    for name in ("m", "mass_deviation", "rigid_residual", "massless", "massless_in_motion", "estimated"):
        arrays[name] = arrays[name].item()
    left_out = notes["dropped"]
    left_out["shapes"] = tuple((node, axis) for node, axis in left_out["shapes"])
    body = FlexibleBody(
        given.name, **arrays, dropped=Dropped(**left_out), stress=_stress(stored), mesh=_mesh(stored)
    )
    places = {"mass": given.mass.place, "stiffness": given.stiffness.place, "body": given.place}
    faults = [
        Fault("warning", text, places[where], given.name, id=name) for where, text, name in notes["warnings"]
    ]
    return body, faults


def _stress(stored: Any) -> BodyStress | None:
    """The stresses of a body whose material is known."""
    if "stress_nodal" not in stored:
        return None
    arrays = {name: stored[f"stress_{name}"] for name in _STRESS}
    return BodyStress(**{name: value if value.ndim else value.item() for name, value in arrays.items()})


def _mesh(stored: Mapping[str, np.ndarray]) -> BodyMesh | None:
    """The elements of a body that is drawn by them alone."""
    if "mesh_rows" not in stored:
        return None
    return BodyMesh(**{name: stored[f"mesh_{name}"] for name in _MESH})


def store(given: FlexibleInput, body: FlexibleBody, warnings: list[Fault]) -> None:
    """Keep `body`; a disk that refuses it is passed over, for the cache only saves time."""
    folder = cache_folder()
    if folder is None:
        return
    where = {given.mass.place: "mass", given.stiffness.place: "stiffness", given.place: "body"}
    notes = {
        "warnings": [(where.get(fault.place, "body"), fault.message, fault.id) for fault in warnings],
        "dropped": vars(body.dropped),
    }
    arrays = {name: np.asarray(getattr(body, name)) for name in _ARRAYS}
    if body.stress:
        arrays |= {f"stress_{name}": np.asarray(getattr(body.stress, name)) for name in _STRESS}
    if body.mesh:
        arrays |= {f"mesh_{name}": getattr(body.mesh, name) for name in _MESH}
    try:
        _write(folder, key_of(given), notes | {"arrays": list(arrays)}, arrays.values())
    except OSError:
        return


def _write(folder: Path, key: str, notes: Mapping[Any, Any], arrays: Iterable[Any]) -> None:
    import tempfile

    handle, temporary = tempfile.mkstemp(dir=folder, suffix=".part")
    try:
        content = io.BytesIO()
        for array in (np.array(json.dumps(notes)), *arrays):
            np.save(content, array, allow_pickle=False)
        with os.fdopen(handle, "wb") as stream:
            stream.write(content.getvalue())
            stream.write(_digest(key, content.getvalue()))
        os.replace(temporary, folder / f"{key}{_ENDING}")
    except BaseException:
        os.unlink(temporary)
        raise


def flexible_body(given: FlexibleInput, cached: bool = True) -> tuple[FlexibleBody, list[Fault]]:
    """The body that `given` describes, and what was doubtful about its files.

    Raises ModelError with every fault found, at the cards of the files.
    """
    stored = load(given) if cached else None
    if stored is not None:
        return stored
    # Most runs find their bodies in the cache and do without.
    from .reduction import reduced_body

    findings = Findings()
    body = with_interface_nodes(reduced_body(own_input(given), findings), given, findings)
    if body is None or any(fault.severity == "error" for fault in findings.faults):
        raise ModelError(findings.in_order)
    if cached:
        store(given, body, findings.faults)
    return body, findings.in_order
