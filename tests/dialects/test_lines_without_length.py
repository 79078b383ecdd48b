"""Springs in line whose ends coincide at the start and which push there: they have no direction."""

import numpy as np
import pytest

from flexmb_cli.errors import ModelError
from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.solvers.constrained.tree import AbsoluteTree
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.dialects.dafms.dafms_decks import build
from tests.dialects.dafms.test_dafms_elements import deck
from tests.dialects.vsdf.element_cases import turned
from tests.solvers.constrained.element_decks import ARM, analysis_of, model_of

# The ends are P = (1, 0, 0) of the ground and the joint between both links, which is there at the start.
MASSES = "MASS 2 1.5 0.4 0 0 0.1 0.2 0.2\nMASS 3 0.8 0.3 0 0 0.05 0.1 0.1\n"
DRIVERS = (
    "ELEMENTS\n"
    "  FUNCTION 1 polynomial 0 1\n"
    "  DRIVE angle-1 at=1.angle value=1\n"
    "  DRIVE angle-2 at=2.angle value=1\n"
)
LINE = "ELEMENTS\n  SPRING lspring-1 from=0(1,0,0) to=2(1,0,0)"
# Stiffness, rest, damping, preload, curve of the length - rest; -(preload + k s + curve(s)) at s = -rest.
PUSHED = {
    "stiffness=100 rest=0.2": "pushes with 20 N",
    "preload=5": "pulls with 5 N",
    "rest=0.5 curve=9": "pulls with 1.5 N",
}
AT_REST = {
    "stiffness=100": "it draws to its own middle",
    "stiffness=100 damping=7": "a damper acts as soon as the ends are apart",
    "stiffness=100 rest=0.2 preload=20": "preload and stiffness cancel each other",
}
CURVE = "ELEMENTS\n  FUNCTION 9 polynomial 0 -3\n"  # N, of metres


def motion(line, analysis):
    cards = f"{MASSES}{DRIVERS if analysis == 'inverse' else ''}{CURVE}{LINE} {line}\n"
    return analysis_of(model_of(ARM, "0 0.1 0.05", cards, analysis))


@pytest.mark.parametrize("analysis", ["forward", "inverse"])
@pytest.mark.parametrize("line", PUSHED)
def test_a_force_without_a_direction_is_refused(line, analysis):
    with pytest.raises(ModelError) as refused:
        next(motion(line, analysis).rows())
    (fault,) = refused.value.faults
    assert fault.sentence.startswith(
        f"lspring-1: its ends coincide at t = 0 s, where it {PUSHED[line]} in no"
    )
    assert fault.place is not None


@pytest.mark.parametrize("line", AT_REST)
def test_a_spring_that_bears_nothing_there_begins(line):
    assert next(motion(line, "forward").rows()).element_effort[0] == pytest.approx(0.0)


def test_a_cable_is_slack_there():
    cards = f"{MASSES}ELEMENTS\n  CABLE cable-1 from=0(1,0,0) to=2(1,0,0) stiffness=100 rest=0.2\n"
    assert next(analysis_of(model_of(ARM, "0 0.1 0.05", cards)).rows()).element_effort[0] == 0.0


def dafms(rest):
    """The tip of body 1 and the point (1, 0, 0) of the inertial frame, where it is at the start."""
    return deck(f"ELEMENTS\n  SPRING line from=0(1,0,0) to=1(1,0,0) stiffness=30 rest={rest}")


def vsdf(rest):
    case = turned(f"NODE\n 0,9,0,0,0\nELEMENTS\n  SPRING lspr-1 from=0:9 to=1:1 stiffness=30 rest={rest:g}\n")
    return f"{case.mechanism}{case.cards}TIME\n 1,0.1\nEND\nSTAR\nSTOP\n"


@pytest.mark.parametrize(("text", "name"), [(dafms, "x.DAT"), (vsdf, "x.vsdf")])
def test_dafms_and_vsdf_decks_are_refused_with_the_card(text, name, tmp_path):
    path = tmp_path / name
    for rest, code in ((0.2, 2), (0.0, 0)):
        path.write_text(text(rest))
        outcome = check_deck(str(path), RunOptions()).outcome
        assert outcome.exit_code == code
        told = [fault for fault in outcome.faults if "its ends coincide" in fault.sentence]
        assert len(told) == (code == 2)
        assert all("pushes with 6 N" in fault.sentence and fault.place is not None for fault in told)


def test_both_formulations_of_a_tree_begin_where_a_line_has_no_length():
    """The one divided 0 by 0 there, and its steps vanished."""
    tree = build(dafms(0.0))[0]
    one, other = (np.concatenate([r.q for r in kind(tree).rows()]) for kind in (AbsoluteTree, TreeAnalysis))
    assert np.ptp(one[:, 0]) > 0.1
    assert other == pytest.approx(one, abs=1e-8)
