"""A flexible body in its floating frame: nodes, modes, inertia invariants; nothing here has a time.

Vlasenko and Kasper (2008), with the invariants of a modal basis: qf = Phi eta, r = r0 + qf, body axes.
S is the mass matrix of the finite-element program.  Of solid elements S^ij = m_ij E, so that the n x n matrix
m of scalars is all that inertia needs; of others see `fe.estimated_moments`.
"""

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ..errors import Place


@dataclass(frozen=True)
class FEFile:
    """A file named by the deck: where it is, its format, and the place of its card.

    `matrix`: the name of the one that is meant where the file holds several, "" for the usual one.
    """

    path: Path
    form: str
    place: Place | None = None
    matrix: str = ""


@dataclass(frozen=True)
class UnitLoad:
    """A geometric stiffness: that of the acceleration field e_i times coordinate j, i and j from 0."""

    i: int
    j: int
    file: FEFile


@dataclass(frozen=True)
class ElementMaterial:
    """Elements in the `file` of the nodes, of Young's modulus `young`, Pa, and Poisson's ratio.

    `density`, kg/m³, nan where it is not given.  `program`: CCX or ABQ, whose types of elements are meant,
    "" where the deck does not say; `lumped`: whether the mass of elements is; `any_stiffness`: whether
    stresses are wanted also of a stiffness of unknown formulation.
    """

    file: FEFile
    young: float
    poisson: float
    place: Place | None = None
    density: float = float("nan")
    program: str = ""
    lumped: bool = False
    any_stiffness: bool = False


@dataclass(frozen=True)
class InterfaceNode:
    """A node at `position`, m in the axes of the node table, that is coupled to others (RBE2, RBE3).

    `rigid`: it carries its `members` rigidly, with their rotations if it `turns` them; otherwise its
    translation and rotation are the means of theirs by `weights`, and forces and moments on it are spread.
    """

    node: int
    position: np.ndarray  # (3,)
    rigid: bool
    members: tuple[int, ...]
    weights: tuple[float, ...]
    turns: bool = True
    place: Place | None = None


@dataclass(frozen=True)
class FlexibleInput:
    """Data of a deck about a flexible body; nodes by their numbers in the table.

    `reference`: the three nodes of (100)-(102), () for none.  With `clamped` nodes those are held in the
    body frame instead of (103); with neither the frame is that of mean axes.  `modes`: how many, 0 for all.
    `attachment`: nodes of static attachment modes; `interface`: nodes of a Craig-Bampton basis.
    `damping`: alpha, 1/s, beta, s, and the ratio of every mode.  `stiffening`: elements whose stresses
    stiffen the body, `material`: those whose stresses are wanted, `mesh`: the file of elements
    whose material is not known.  `nodal_masses`: nodes and what is added to their masses, kg;
    `stiffness_factor`: of the stiffness and of Young's moduli.
    `axes` (n, 3, 3): those of the displacements of each node, columns, None
    for those of the table.  `ratios`: frequencies, Hz, and damping ratios there, in place of one ratio.
    """

    name: str
    mass: FEFile
    stiffness: FEFile
    numbers: np.ndarray  # (n,) node numbers
    positions: np.ndarray  # (n, 3) in the axes of the node table, m
    mapping: FEFile | None = None
    reference: tuple[int, ...] = ()
    clamped: tuple[int, ...] = ()
    attachment: tuple[int, ...] = ()
    interface: tuple[int, ...] = ()
    modes: int = 0
    damping: tuple[float, float, float] = (0.0, 0.0, 0.0)
    unit_loads: tuple[UnitLoad, ...] = ()
    stiffening: ElementMaterial | None = None
    material: ElementMaterial | None = None
    place: Place | None = None
    mesh: FEFile | None = None
    axes: np.ndarray | None = None  # (n, 3, 3) displacement axes in columns; None: those of the table
    ratios: tuple[tuple[float, float], ...] = ()
    interfaces: tuple[InterfaceNode, ...] = ()
    damping_matrix: FEFile | None = None  # of viscous damping
    nodal_masses: tuple[tuple[int, float], ...] = ()
    stiffness_factor: float = 1.0
    whole: "FlexibleInput | None" = None  # with the nodes that `interfaces` replace, as the files have them

    @property
    def with_factor(self) -> "FlexibleInput":
        """Return the input with Young's moduli times `stiffness_factor`, those of the stiffness."""
        materials = (
            material and replace(material, young=material.young * self.stiffness_factor)
            for material in (self.stiffening, self.material)
        )
        stiffening, material = materials
        return replace(self, stiffening=stiffening, material=material)


@dataclass(frozen=True)
class Dropped:
    """Modes that the body's basis leaves out.

    `internal`: degrees of freedom inside elements, condensed; `shapes`: nodes and axes of the static shapes
    that others or the frame's conditions made superfluous; `modes`: how many eigenmodes of (104) the basis
    is short of all; `next_frequency`: the first that was not requested, Hz, nan when it is not known.
    """

    internal: int = 0
    shapes: tuple[tuple[int, str], ...] = ()
    modes: int = 0
    next_frequency: float = float("nan")

    @property
    def dependent(self) -> int:
        """Return how many static shapes were superfluous."""
        return len(self.shapes)


@dataclass(frozen=True)
class BodyMesh:
    """The elements of a body of no known material, by which it is drawn."""

    numbers: np.ndarray  # (m,) element numbers
    rows: np.ndarray  # (m, k) rows of the elements' nodes


@dataclass(frozen=True)
class BodyStress:
    """The elements of a body in one formulation, and the stresses of its modes at the nodes.

    `deviation`: largest difference between the stiffness that the elements assemble to and that of the
    file, relative to its largest entry.  `assembled`: type and mass of the elements that the matrices are
    made of, "" where a file has these.
    """

    numbers: np.ndarray  # (m,) element numbers
    rows: np.ndarray  # (m, k) rows of the elements' nodes
    formulation: str
    young: float  # Pa
    poisson: float
    deviation: float
    nodal: np.ndarray  # (n, 6, N) Pa per unit of each mode: xx yy zz xy yz zx, body axes
    assembled: str = ""

    @property
    def text(self) -> str:
        """Return the formulation in words, and what the matrices are made of."""
        origin = f"; M and K made of {self.assembled}" if self.assembled else ""
        return f"{len(self.numbers)} elements, {self.formulation}{origin}"


@dataclass(frozen=True)
class FlexibleBody:
    """Frame, basis and invariants of a body with n nodes and N modes; SI units, body axes.

    `origin`, `axes`: the body frame in the axes of the node table; the columns of `axes` are e1 e2 e3.
    """

    name: str
    numbers: np.ndarray  # (n,) node numbers
    r0: np.ndarray  # (n, 3) positions of the undeformed nodes
    origin: np.ndarray  # (3,)
    axes: np.ndarray  # (3, 3)
    Phi: np.ndarray  # (3 n, N) modes, x y z of node 1 first
    m: float  # mass, kg
    s0: np.ndarray  # (3,) 1' S r0
    S1: np.ndarray  # (3, N) 1' S Phi
    J0: np.ndarray  # (3, 3) R0' S R0
    J1: np.ndarray  # (N, 3, 3) P_k' S R0 + R0' S P_k
    J2: np.ndarray  # (N, N, 3, 3) P_k' S P_l
    C0: np.ndarray  # (3, N) R0' S Phi
    C1: np.ndarray  # (N, 3, N) P_k' S Phi
    Mff: np.ndarray  # (N, N) Phi' S Phi, and what puts shapes without mass at the highest frequency
    Kr: np.ndarray  # (N, N) Phi' K Phi
    Dr: np.ndarray  # (N, N) damping
    KG: np.ndarray  # (3, 3, N, N) geometric stiffness per (w~ w~)_ij; (0, 0, N, N) when there is none
    frequencies: np.ndarray  # (N,) Hz; of the last `massless` that of the highest mode with mass
    frequency_errors: np.ndarray  # (N,) relative, from the digits of the files; nan where not known
    effective_mass: np.ndarray  # (N, 6) kg along, kg m^2 about the body's axes at its origin
    effective_limit: np.ndarray  # (6,) their sums over a complete basis
    mass_deviation: float  # largest |S^ij - m_ij E| relative to the largest entry of S
    rigid_residual: float  # largest |K R| of the six rigid motions relative to the largest entry of K
    massless: int = 0  # shapes without mass, the last ones, of unit modal mass all the same
    massless_in_motion: int = 0  # deformations without mass once the nodes of the frame move, see `Mff`
    dropped: Dropped = field(default_factory=Dropped)
    stress: BodyStress | None = None
    mesh: BodyMesh | None = None  # where there is no `stress`
    Psi: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))  # (3 n, N) rotations of the nodes, nan
    # where the matrices have no rows of them; (0, 0) of solid elements, which have none
    estimated: bool = False  # whether J1, J2 and C1 are estimates from M's rows

    @property
    def modes(self) -> int:
        """N, the number of modal coordinates."""
        return int(self.Phi.shape[1])

    def position(self, node: int) -> np.ndarray:
        """Undeformed position of a node (3,), by its number.  Raises KeyError."""
        return self.r0[self._row(node)]

    def shape(self, node: int) -> np.ndarray:
        """Displacement of a node per unit of each modal coordinate, (3, N).  Raises KeyError."""
        row = self._row(node)
        return self.Phi[3 * row : 3 * row + 3]

    def rotation(self, node: int) -> np.ndarray | None:
        """Rotation of a node per unit of each modal coordinate, (3, N); None of one that has none."""
        row = self._row(node)
        shape = self.Psi[3 * row : 3 * row + 3]
        return None if not shape.size or np.isnan(shape).any() else shape

    def _row(self, node: int) -> int:
        rows = np.flatnonzero(self.numbers == node)
        if not rows.size:
            raise KeyError(node)
        return int(rows[0])

    @property
    def centre(self) -> np.ndarray:
        """Centre of mass of the undeformed body (3,), m."""
        return self.s0 / self.m
