"""The kernels' codes of loads are those of the model."""

from flexmb_cli.kernels import forces
from flexmb_cli.model import dynamic_arrays


def test_kernels_and_model_call_the_kinds_of_loads_by_the_same_codes():
    for name in ("FORCE", "TORQUE", "LINE"):
        assert getattr(forces, name) == getattr(dynamic_arrays, name)
