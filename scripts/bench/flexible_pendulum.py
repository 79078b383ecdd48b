"""The pendulum of decks/vsdf in Exudyn, as flexmb has it; parts `agree` and `equal-error` of flexible.py.

54 nodes, 162 degrees of freedom, released horizontally.  Both programs describe the same motions:

* M, K and the nodes are the files of the deck.
* The hinge holds node 1 in x, y, z and node 5 in x, z: the five equations of the deck's REVO.  The mean of
  the root face, 7.5 mm above them, is another hinge.
* The shapes span the same space.  Exudyn's LoadMassProportional leaves out the moment of gravity on modal
  displacements, which vanishes for shapes of no mean displacement.  Subtracting from each shape its mean, a
  constant translation, only names another origin of the floating frame: x + A (r0 + Phi eta) stays the same
  set of motions.
"""

from pathlib import Path

import flexible_slider
import numpy as np
from scipy import linalg
from scipy.io import mmread

DECKS = Path(__file__).resolve().parents[2] / "decks" / "vsdf"
TIP, HINGE = 51, ((1, [1, 1, 1]), (5, [1, 0, 1]))  # node numbers, axes that are held
GRAVITY = [0.0, 0.0, -9.81]
FINE = 2e-5  # s, the shorter one of the two steps of `converged`


def files():
    """Nodes (54, 3), M and K of the deck."""
    nodes = np.loadtxt(DECKS / "fe" / "pendulum_nodes.txt", comments=("*", "#"))[:, 1:4]
    M, K = (mmread(DECKS / "fe" / f"pendulum_{name}.mtx").tocsr() for name in ("M", "K"))
    return nodes, M, K


def shapes_without_mean(Phi: np.ndarray, M, K) -> tuple[np.ndarray, np.ndarray]:
    """Return shapes that span the space of Phi up to translations, and their squared frequencies."""
    translations = np.tile(np.eye(3), (len(Phi) // 3, 1))
    mass = (translations.T @ (M @ translations))[0, 0]
    Phi = Phi - translations @ (translations.T @ (M @ Phi)) / mass
    squares, mixed = linalg.eigh(Phi.T @ (K @ Phi), Phi.T @ (M @ Phi))
    return Phi @ mixed, squares


def exudyn_pendulum(body):
    """The system of the flexible `body` of flexmb, and the sensor of its tip."""
    import exudyn as exu
    import exudyn.itemInterface as item
    from exudyn.FEM import FEMinterface, ObjectFFRFreducedOrderInterface

    nodes, M, K = files()
    if not np.allclose(body.axes, np.eye(3)):
        raise ValueError("the axes of the body's frame must be those of the nodes")
    mbs, fem = exu.SystemContainer().AddSystem(), FEMinterface()
    shapes, fem.eigenValues = shapes_without_mean(np.array(body.Phi), M, K)
    fem.nodes, fem.modeBasis = {"Position": nodes}, {"matrix": shapes, "type": "NormalModes"}
    fem.massMatrix, fem.stiffnessMatrix = M, K
    interface = ObjectFFRFreducedOrderInterface(fem)
    rod = interface.AddObjectFFRFreducedOrder(mbs, gravity=GRAVITY)["oFFRFreducedOrder"]
    ground = mbs.AddObject(item.ObjectGround())
    for number, axes in HINGE:
        fixed = item.MarkerBodyPosition(bodyNumber=ground, localPosition=list(nodes[number - 1]))
        node = {"meshNodeNumbers": [number - 1], "weightingFactors": [1.0]}
        held = item.MarkerSuperElementPosition(bodyNumber=rod, **node)
        ends = [mbs.AddMarker(fixed), mbs.AddMarker(held)]
        mbs.AddObject(item.SphericalJoint(markerNumbers=ends, constrainedAxes=axes))
    tip = {"meshNodeNumber": TIP - 1, "outputVariableType": exu.OutputVariableType.Position}
    sensor = mbs.AddSensor(item.SensorSuperElement(bodyNumber=rod, storeInternal=True, **tip))
    mbs.Assemble()
    return mbs, sensor


def exudyn_integration(body, step, tolerance, end, rows):
    """Run by generalised-alpha: (places (rows, 3) of the tip at even times, processor seconds, steps)."""
    mbs, sensor = exudyn_pendulum(body)
    return flexible_slider.solve(mbs, [sensor], step, end, rows, tolerance)


def converged(body, end, rows):
    """Exudyn's places for steps of no length, from two runs whose errors go with the square of the step.

    Returns them and the largest correction made.
    """
    coarse, fine = (exudyn_integration(body, h, 1e-10, end, rows)[0] for h in (2 * FINE, FINE))
    return fine + (fine - coarse) / 3, np.abs(fine - coarse).max() / 3
