"""Stresses, strains and element energies of flexible bodies in a result, and the elements of those bodies.

Everything is in the axes of the body.  Strains follow from stresses by Hooke's law; an element's stress is
the mean over its volume; von Mises and principal stresses are those of the averaged tensors.
"""

import math
from collections.abc import Iterator

import numpy as np

from ...model.flexible_body import BodyStress
from ...model.flexible_mechanism import FlexibleMechanism, FloatingBody, StressOutput
from .layout import Axis, Constant, Series, Values

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")
YOUNG, POISSON = "young_modulus", "poisson_ratio"
# Rows at a time: the stresses of all nodes of a large body are many numbers.
MOST_STRESSES = 2**22


def _stress(body: FloatingBody) -> BodyStress:
    stress = body.reduced.stress
    assert stress is not None, "stresses are reported of a body of known material"
    return stress


def _strains(stress: np.ndarray, body: FloatingBody) -> np.ndarray:
    return strains(stress, _stress(body).young, _stress(body).poisson)


def element_axes(body: FloatingBody) -> list[Axis]:
    """The elements of a body by their numbers, and their nodes; of known material, components of stress."""
    cells, group = body.reduced.stress or body.reduced.mesh, f"elastic/{body.name}"
    if cells is None:
        return []
    corners = tuple(range(1, cells.rows.shape[1] + 1))
    component = Axis(f"{group}/component", COMPONENTS, "component of stress")
    return [
        Axis(f"{group}/element", tuple(map(int, cells.numbers)), f"element of {body.name}, its number"),
        Axis(f"{group}/corner", corners, "node of an element, as Abaqus counts them"),
        *([component] if body.reduced.stress else []),
    ]


def element_constants(body: FloatingBody) -> Iterator[Constant]:
    """Nodes of the elements, and the stresses of the modes where the material is known."""
    stress, group = body.reduced.stress, f"elastic/{body.name}"
    if cells := stress or body.reduced.mesh:
        meaning = f"numbers of the nodes of every element of {body.name}"
        meaning += f"; {stress.formulation}" if stress else ""
        numbers = body.reduced.numbers[cells.rows]
        yield Constant(f"{group}/cell", (f"{group}/element", f"{group}/corner"), numbers, "1", meaning)
    if stress is None:
        return
    axes = (f"{group}/node", f"{group}/component", f"modal/{body.name}/mode")
    meaning = f"stress at the nodes of {body.name} per unit of each mode, axes of the body"
    yield Constant(f"{group}/stress_shape", axes, stress.nodal, "Pa or Pa/m", meaning)
    modulus, ratio = np.array(stress.young), np.array(stress.poisson)
    yield Constant(f"{group}/{YOUNG}", (), modulus, "Pa", f"Young's modulus of {body.name}")
    yield Constant(f"{group}/{POISSON}", (), ratio, "1", f"Poisson's ratio of {body.name}")


def stress_axes(mechanism: FlexibleMechanism) -> list[Axis]:
    """Nodes and elements whose stresses are reported, and components."""
    axes = []
    for output in mechanism.stresses:
        group = _group(mechanism, output)
        axes.append(Axis(f"{group}/component", COMPONENTS, "component"))
        axes.append(Axis(f"{group}/principal", (1, 2, 3), "principal value, the largest first"))
        for kind, numbers in (("node", output.nodes), ("element", output.elements)):
            if len(numbers):
                axes.append(Axis(f"{group}/{kind}", tuple(map(int, numbers)), f"number of the {kind}"))
    return axes


def stress_series(mechanism: FlexibleMechanism) -> list[Series]:
    """Return what is reported of every body."""
    return [series for output in mechanism.stresses for series in _series(mechanism, output)]


def _series(mechanism: FlexibleMechanism, output: StressOutput) -> Iterator[Series]:
    group, strain = _group(mechanism, output), _group(mechanism, output, "strain")
    name = mechanism.bodies[output.body].name
    for kind, numbers, where, of_mean in (
        ("node", output.nodes, "mean over the elements at the node", "mean stress at the node"),
        ("element", output.elements, "mean over the element", "mean stress of the element"),
    ):
        if not len(numbers):
            continue
        axis = f"{group}/{kind}"
        tensor, principal = (axis, f"{group}/component"), (axis, f"{group}/principal")
        yield Series(f"{group}/{kind}_tensor", tensor, "Pa", f"stress, {where}, axes of {name}")
        yield Series(f"{group}/{kind}_von_mises", (axis,), "Pa", f"von Mises stress of the {of_mean}")
        yield Series(f"{group}/{kind}_principal", principal, "Pa", f"principal stresses of the {of_mean}")
        yield Series(
            f"{strain}/{kind}_tensor", tensor, "1", f"strain, {where}, axes of {name}; xy is half the angle"
        )
        yield Series(f"{strain}/{kind}_principal", principal, "1", f"principal strains of the {of_mean}")
    if len(output.elements):
        yield Series(f"{strain}/element_energy", (f"{group}/element",), "J", "strain energy of the element")
    if output.largest:
        yield Series(f"{group}/max_von_mises", (), "Pa", f"largest von Mises stress at a node of {name}")
        yield Series(f"{group}/max_node", (), "1", "number of that node")


def _group(mechanism: FlexibleMechanism, output: StressOutput, quantity: str = "stress") -> str:
    return f"{quantity}/{mechanism.bodies[output.body].name}"


def stress_values(mechanism: FlexibleMechanism, values: Values) -> dict[str, np.ndarray]:
    """Return the series for report rows whose modal coordinates are among `values`."""
    series: dict[str, np.ndarray] = {}
    for output in mechanism.stresses:
        body = mechanism.bodies[output.body]
        eta = values[f"modal/{body.name}/amplitude"]
        group, strain = _group(mechanism, output), _group(mechanism, output, "strain")
        means = np.einsum("egan,eg->ean", output.points, output.volumes)
        means /= output.volumes.sum(axis=1)[:, None, None]
        for kind, shapes in (("node", output.nodal), ("element", means)):
            if len(shapes):
                tensor = np.einsum("san,tn->tsa", shapes, eta)
                series[f"{group}/{kind}_tensor"] = tensor
                series[f"{group}/{kind}_von_mises"] = von_mises(tensor)
                series[f"{group}/{kind}_principal"] = principal_stresses(tensor)
                strained = _strains(tensor, body)
                series[f"{strain}/{kind}_tensor"] = strained
                series[f"{strain}/{kind}_principal"] = principal_stresses(strained)
        if len(output.elements):
            series[f"{strain}/element_energy"] = element_energies(output, body, eta)
        if output.largest:
            largest = largest_von_mises(body, eta)
            series[f"{group}/max_von_mises"], series[f"{group}/max_node"] = largest
    return series


def von_mises(stress: np.ndarray) -> np.ndarray:
    """Equivalent stress (...) of tensors (..., 6)."""
    xx, yy, zz, xy, yz, zx = np.moveaxis(stress, -1, 0)
    direct = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.sqrt(direct / 2 + 3 * (xy**2 + yz**2 + zx**2))


def principal_stresses(stress: np.ndarray) -> np.ndarray:
    """Principal values (..., 3), the largest first, of tensors (..., 6)."""
    full = stress[..., [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(*stress.shape[:-1], 3, 3)
    return np.linalg.eigvalsh(full)[..., ::-1]


def strains(stress: np.ndarray, young: float, poisson: float) -> np.ndarray:
    """Strain tensors (..., 6) of stresses by Hooke's law, E in Pa; xy yz zx are halves of angles."""
    strain = stress * ((1 + poisson) / young)
    strain[..., :3] -= poisson / young * stress[..., :3].sum(axis=-1, keepdims=True)
    return strain


def element_energies(output: StressOutput, body: FloatingBody, eta: np.ndarray) -> np.ndarray:
    """Strain energies (T, e), J, of the reported elements: the integral of sigma : epsilon / 2."""
    shapes, volumes = output.points, output.volumes
    strain = _strains(np.moveaxis(shapes, 2, -1).copy(), body)
    doubled = np.moveaxis(strain, -1, 2) * np.array([1, 1, 1, 2, 2, 2])[:, None]
    energies = np.einsum("egam,egan,eg->emn", shapes, doubled, volumes, optimize=True) / 2
    return np.einsum("emn,tm,tn->te", energies, eta, eta, optimize=True)


def largest_von_mises(body: FloatingBody, eta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Largest equivalent stress (T,) at any node, and the number of that node (T,)."""
    shapes = _stress(body).nodal
    largest, node = np.empty(len(eta)), np.empty(len(eta))
    rows = max(1, MOST_STRESSES // math.prod(shapes.shape[:2]))
    for first in range(0, len(eta), rows):
        part = slice(first, first + rows)
        equivalent = von_mises(np.einsum("san,tn->tsa", shapes, eta[part], optimize=True))
        place = equivalent.argmax(axis=1)
        largest[part] = equivalent[np.arange(len(place)), place]
        node[part] = body.reduced.numbers[place]
    return largest, node
