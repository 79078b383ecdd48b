"""Contacts, sampled and continuous signals, cams and curves: stopped runs resume to the same bytes."""

import pytest

from flexmb_cli.solvers.constrained import analysis as constrained
from flexmb_cli.solvers.tree import steps
from tests.dialects.dafms.test_dafms_elements import MASSES, TWO_LINKS
from tests.run.resume.stopped_runs import resumed
from tests.solvers.constrained.element_decks import ARM

# Samples at 0.02 s, given out 0.05 s later: rows lie at samples, between them and at what is given out.
SIGNALS = """  SIGNAL error sum 0.3 -FIRST
  SIGNAL held pid of=error kp=4 ki=3 kd=0.1 period=0.02 delay=0.05
  SIGNAL slow transfer of=error numerator=(20) denominator=(1,4,20)
  SIGNAL u sum held slow
  MOTOR m at=FIRST effort=u
"""
FLOOR = (
    "  CONTACT floor plane-point from=0(0,-0.25,0) normal=(0,1,0) to=TIP(1,0,0) stiffness=2e4 "
    "damping=0.2 friction=0.2\n"
)
LOOSE = (
    "  FUNCTION lift polynomial 0.2 -1\n"
    "  COUPLING loose from=FIRST to=SECOND function=lift stiffness=40 damping=0.3\n"
)
CAM = "  FUNCTION lift polynomial 0 -1.4 0.3\n  COUPLING cam from=FIRST to=SECOND function=lift\n"
RAIL = (
    "  FUNCTION x polynomial 1.3 -0.3 0.2\n  FUNCTION y polynomial 0.2 -1 -0.3\n"
    "  CURVE rail from=0(0,0,0) to=TIP(0.3,0.2,0) x=x y=y begin=-0.2 end=2\n"
)
BLOCKS = {"contact": SIGNALS + FLOOR + LOOSE, "cam": SIGNALS + CAM + FLOOR, "rail": SIGNALS + RAIL}
METHODS = ("dop853", "radau", "lsoda", "sdirk4")


def named(lines, first, second, tip):
    return "ELEMENTS\n" + lines.replace("FIRST", first).replace("SECOND", second).replace("TIP", tip)


def tree(lines):
    """The arm of two links, 41 rows 0.01 s apart."""
    start = TWO_LINKS.replace("    5\n       0.1\n", "   40\n      0.01\n")
    start = start.replace("    1.000E-12    1.000E-13\n", "    1.000E-07    1.000E-08\n")
    return f"{start}{named(lines, '1.r3', '2.r3', '2')}END \nSTAR\nSTOP\n"


def young(lines, method):
    """The same arm, by multipliers."""
    card = {"DOP853": "TOLERANCE 1e-7\n", "RAD5": "RAD5 1e-6\n", "GALF": "GALF 0.004 0.9\n"}[method]
    block = named(lines, "1.angle", "2.angle", "3")
    return f"{ARM}0 0.4 0.01\nDYNAMICS forward\n{MASSES}{card}{block}END\n"


@pytest.fixture(autouse=True)
def short_blocks(monkeypatch):
    """Blocks of three rows, which end before, at and after samples."""
    for module in (constrained, steps):
        monkeypatch.setattr(module, "LARGEST_BLOCK", 3)


@pytest.mark.long_motion
@pytest.mark.parametrize("lines", BLOCKS)
@pytest.mark.parametrize("method", METHODS)
def test_elements_of_trees_resume_to_the_same_bytes(tmp_path, method, lines):
    options = {"integration": {"method": method}}
    whole, stopped = resumed(tmp_path, "ARM.DAT", tree(BLOCKS[lines]), (1, 2, 4), **options)
    assert stopped == whole


@pytest.mark.long_motion
@pytest.mark.parametrize("lines", BLOCKS)
@pytest.mark.parametrize("method", ["DOP853", "RAD5", "GALF"])
def test_elements_of_mechanisms_resume_to_the_same_bytes(tmp_path, method, lines):
    whole, stopped = resumed(tmp_path, "IN-ARM.dat", young(BLOCKS[lines], method), (1, 2, 4))
    assert stopped == whole
