"""The kernels' codes of loads are those of the model."""

from flexmb_cli.kernels.constrained import forces
from flexmb_cli.model.arrays import dynamic


def test_kernels_and_model_call_the_kinds_of_loads_by_the_same_codes():
    for name in ("FORCE", "TORQUE", "LINE"):
        assert getattr(forces, name) == getattr(dynamic, name)
