"""Mass and stiffness of bodies of beams and shells, six rows a node in the axes of the node table."""

import numpy as np

from ...model.flexible_body import ElementMaterial
from ..formats.matrix_file import FEFileFault, MatrixFile, labelled
from ..formats.node_table import NodeTable, read_node_table
from ..formats.structure_elements import StructureTable, read_structures
from .beams import beam_matrices
from .shells import shell_mass, shell_stiffness


def matrix_of_structures(material: ElementMaterial, letter: str) -> MatrixFile:
    """Return M or K (`letter`) of the beams and shells in the file of `material`.  Raises FEFileFault."""
    path, form = material.file.path, material.file.form
    if material.lumped:
        message = f"{path.name}: the mass of beams and shells is consistent; take CONS on ELMT"
        raise FEFileFault(message, id="FE-278")
    nodes = read_node_table(path, form)
    elastic = material.young, material.poisson, material.density
    table = read_structures(path, form, nodes, elastic)
    with np.errstate(all="ignore"):  # what is not finite is refused as in files of matrices
        return structure_matrix(table, nodes, elastic, letter)


def structure_matrix(
    table: StructureTable, nodes: NodeTable, elastic: tuple[float, float, float], letter: str
) -> MatrixFile:
    """Return M or K (`letter`); `elastic`: Young's modulus, Pa, Poisson's ratio, density, kg/m³."""
    parts = []
    if table.beams is not None:
        parts.append((table.beams.rows, beam_matrices(table.beams, nodes.positions, elastic, letter)))
    if len(table.shells):
        corners, (thickness, extra) = nodes.positions[table.shells], table.sections.T
        young, poisson, density = elastic
        blocks = (
            shell_stiffness(corners, thickness, young, poisson)
            if letter == "K"
            else shell_mass(corners, thickness, density, extra)
        )
        parts.append((table.shells, blocks))
    entries, values = zip(*(_entries(nodes.numbers[rows], blocks) for rows, blocks in parts), strict=True)
    return labelled(np.concatenate(entries), np.concatenate(values), False)


def _entries(numbers: np.ndarray, blocks: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return node and component of rows and columns, (m s s, 4), and the values of matrices (m, s, s)."""
    components = np.broadcast_to(np.arange(1, 7), (*numbers.shape, 6))
    labels = np.stack([np.broadcast_to(numbers[..., None], components.shape), components], axis=-1)
    labels = labels.reshape(len(numbers), -1, 2)
    size = labels.shape[1]
    rows, columns = np.repeat(labels, size, axis=1), np.tile(labels, (1, size, 1))
    return np.concatenate([rows, columns], axis=2).reshape(-1, 4), blocks.ravel()
