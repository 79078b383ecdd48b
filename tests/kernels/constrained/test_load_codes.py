"""The kernels' codes of loads and functions are those of the model."""

from flexmb_cli.kernels import laws as of_elements
from flexmb_cli.kernels.constrained import elements, forces
from flexmb_cli.kernels.constrained import time_functions as of_kernels
from flexmb_cli.kernels.tree import elements as of_trees
from flexmb_cli.model import laws, time_functions
from flexmb_cli.model.arrays import records, tree_elements


def test_kernels_and_model_call_the_kinds_of_loads_by_the_same_codes():
    for name in ("FORCE", "TORQUE"):
        assert getattr(forces, name) == getattr(records, name)
    for name in ("ELEMENT", "FRICTION"):
        assert getattr(elements, name) == getattr(records, name)


def test_kernels_and_model_call_what_elements_measure_and_their_laws_by_the_same_codes():
    for name in ("IN_COORDINATE", "IN_LINE", "ALONG", "ABOUT"):
        assert getattr(of_trees, name) == getattr(tree_elements, name)
    for law in (law for law in laws.LAWS if {laws.At, laws.Line} & set(law.measures)):
        assert getattr(of_elements, law.word) == law.code


def test_kernels_and_model_call_the_kinds_of_functions_by_the_same_codes():
    for name in ("POLYNOMIAL", "SPIN_UP", "SINE", "TABLE", "HELD_TABLE", "PIECEWISE", "COMPOUND"):
        assert getattr(of_kernels, name) == getattr(time_functions, name)
