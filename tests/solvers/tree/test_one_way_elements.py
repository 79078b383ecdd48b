"""Elements of trees with UNCO: at rest of the nodes the rigid motion is that of rigid bodies."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.model.flexible_mechanism import NodePoint
from flexmb_cli.model.joint_elements import Coupling, JointElements
from flexmb_cli.model.laws import FRICTION, Element, Joint, Line, spring
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import ELASTIC, INERTIAL
from flexmb_cli.solvers.constrained.tree import AbsoluteTree
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.naive.random_trees import motored, sprung
from tests.solvers.tree.tree_runs import deck_tree

TURN = "rotation 1"
GROUND = NodePoint("end a", INERTIAL, np.array([0.0, 0.3, 0.4]), np.zeros((3, 0)))
TIP = NodePoint("end b", 1, np.array([0.0, 0.9, 0.0]), np.zeros((3, 0)))
RUBBING = (0.3, 0.4, 0.1, 0.01, 0.05, 2.0, 0.0, 0.0)
ELEMENTS = {
    "friction": JointElements(forces=(Element("f", FRICTION, Joint(0), RUBBING),)),
    "coupling": JointElements(couplings=(Coupling("c", ((0, TURN, 1.0), (1, TURN, 2.0))),)),
    "both": JointElements(
        forces=(Element("f", FRICTION, Joint(1), RUBBING),),
        couplings=(Coupling("c", ((0, TURN, 1.0), (1, TURN, 2.0))),),
    ),
    "line": JointElements(forces=(spring("l", Line(INERTIAL, 1, GROUND, TIP), 60.0, 0.5, 2.0),)),
    "spring": sprung((1, "rotation", 1, 30.0, 0.2, 0.4)),
    "motor": motored(0, "rotation", 1, (0.0, 4.0)),
}


def rigid(tree):
    """The tree of rigid bodies with the masses of its flexible ones."""
    bodies, hinges, tips = [], [], {}
    for k, body in enumerate(tree.bodies):
        masses, places = body.elastic.masses, body.elastic.positions
        tips[k] = places
        bodies.append(replace(body, elastic=None, centre=tuple(masses @ places / body.mass)))
    for hinge in tree.hinges:
        point = hinge.point if hinge.node is None else tuple(tips[hinge.parent][hinge.node])
        hinges.append(replace(hinge, point=point, node=None, elastic_rotation=None))
    kept = [m for m, c in enumerate(tree.coordinates) if c.motion != ELASTIC]
    return replace(
        tree, bodies=tuple(bodies), hinges=tuple(hinges), q=tree.q[kept], y=tree.y[kept], one_way=False
    ), kept


@pytest.mark.parametrize("name", ELEMENTS)
def test_the_rigid_motion_is_that_of_rigid_bodies(name):
    tree = deck_tree("two_link_n2_unco", time=TimeGrid(0.0, 0.0, 0.1), gravity=(0.0, 0.0, -9.81))
    q, y = np.zeros(len(tree.q)), np.zeros(len(tree.y))
    q[:2], y[:2] = (0.3, 0.5), (0.8, -0.4)
    tree = replace(tree, q=q, y=y, elements=ELEMENTS[name])
    stiff, kept = rigid(tree)
    one, other = next(TreeAnalysis(tree).rows()), next(AbsoluteTree(stiff).rows())
    assert np.abs(other.y_rate).max() > 0.5
    assert one.y_rate[:, kept] == pytest.approx(other.y_rate, rel=1e-9)
    assert one.element_effort == pytest.approx(other.element_effort, rel=1e-9, abs=1e-12)
    assert one.coupling_effort == pytest.approx(other.coupling_effort, rel=1e-9)
