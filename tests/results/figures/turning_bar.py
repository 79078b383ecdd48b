"""A result of the bar of `conftest` that turns about y, with the closed form of what is drawn of it."""

import numpy as np

from flexmb_cli.model.joint_elements import COORDINATES_OF
from flexmb_cli.results.hdf5.kinematic import kinematic_layout, kinematic_values
from flexmb_cli.results.hdf5.result_file import ResultFile

SPEED = 1.047  # rad/s, about y: the driver of IN2-1-1


def write_bar(path, deck, mechanism, rows, times, status="complete", message=""):
    """The result at `path`; bodies, joint and point as the fixtures of `conftest` have them."""
    result = ResultFile(path, deck, kinematic_layout(mechanism))
    if len(times):
        coordinates = sum(len(COORDINATES_OF[joint.kind]) for joint in mechanism.joints)
        result.rows(kinematic_values(rows(times, coordinates)))
    result.close(status, message)
    return path


def tip(times):
    """The point at the bar's free end, two from the origin (T, 3)."""
    angle = SPEED * np.asarray(times)
    return 2 * np.stack([np.cos(angle), 0 * angle, -np.sin(angle)], axis=-1)
