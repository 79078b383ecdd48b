"""The kernels' codes of loads and functions are those of the model."""

from flexmb_cli.kernels.constrained import elements, forces
from flexmb_cli.kernels.constrained import time_functions as of_kernels
from flexmb_cli.model import time_functions
from flexmb_cli.model.arrays import records


def test_kernels_and_model_call_the_kinds_of_loads_by_the_same_codes():
    for name in ("FORCE", "TORQUE", "LINE", "RELATIVE"):
        assert getattr(forces, name) == getattr(records, name)
    for name in ("ELEMENT", "FRICTION", "SPRING", "STOP", "CABLE"):
        assert getattr(elements, name) == getattr(records, name)


def test_kernels_and_model_call_the_kinds_of_laws_by_the_same_codes():
    for name in ("POLYNOMIAL", "SPIN_UP", "SINE", "TABLE", "HELD_TABLE", "PIECEWISE", "COMPOUND"):
        assert getattr(of_kernels, name) == getattr(time_functions, name)
