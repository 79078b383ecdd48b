"""Primitives for pictures: volumes, sides and places by closed forms."""

import math

import numpy as np
import pytest

from flexmb_cli.model.shapes import BOX, CONE, CYLINDER, SIDES, SPHERE, TUBE, fault_of_sizes, primitive

# Area of the regular polygon of SIDES corners in the unit circle, which stands for it.
CIRCLE = SIDES / 2 * math.sin(2 * math.pi / SIDES)


def enclosed(shape):
    """Volume inside the surface by the divergence theorem: positive where triangles face outwards."""
    a, b, c = np.moveaxis(shape.vertices[shape.triangles], 1, 0)
    return float(np.sum(a * np.cross(b, c)) / 6)


@pytest.mark.parametrize(
    ("kind", "sizes", "volume"),
    [
        (BOX, (2, 3, 4), 24),
        (CYLINDER, (0.5, 4, 0), CIRCLE * 0.25 * 4),
        (TUBE, (0.5, 4, 0.3), CIRCLE * (0.25 - 0.09) * 4),
        (CONE, (0.5, 4, 0), CIRCLE * 0.25 * 4 / 3),
        (CONE, (0.5, 4, 0.3), CIRCLE * (0.25 + 0.15 + 0.09) * 4 / 3),
    ],
)
def test_the_volume_is_that_of_the_body(kind, sizes, volume):
    shape = primitive(2, kind, sizes, (7, -8, 9), (0.3, -0.2, 0.1))
    assert enclosed(shape) == pytest.approx(volume, rel=1e-10)


def test_a_sphere_is_closed_and_lies_on_its_radius():
    shape = primitive(1, SPHERE, (2, 0, 0), (1, 2, 3), (0, 0, 0))
    assert np.linalg.norm(shape.vertices - (1, 2, 3), axis=1) == pytest.approx(2.0, rel=1e-11)
    assert 0.96 * 4 / 3 * math.pi * 8 < enclosed(shape) < 4 / 3 * math.pi * 8


def test_angles_turn_about_fixed_axes_x_y_z_in_turn():
    """Roll, pitch, yaw of URDF: the z axis goes to -y by roll pi/2, pitch leaves it, yaw takes it to x."""
    shape = primitive(1, CONE, (0.1, 2, 0), (1, 0, 0), (math.pi / 2, math.pi / 2, math.pi / 2))
    tip = shape.vertices[np.argmax(shape.vertices[:, 0])]
    assert tip == pytest.approx([2, 0, 0], abs=1e-11)


@pytest.mark.parametrize(
    ("kind", "sizes", "wrong"),
    [
        (BOX, (1, 1, 0), 2),
        (CYLINDER, (1, -1, 0), 1),
        (CYLINDER, (1, 1, 1), 2),
        (SPHERE, (1, 1, 0), 1),
        (TUBE, (1, 1, 1), 2),
        (TUBE, (1, 1, 0), 2),
        (CONE, (1, 1, -1), 2),
        (BOX, (math.nan, 1, 1), 0),
    ],
)
def test_sizes_that_make_no_body_are_faults(kind, sizes, wrong):
    assert fault_of_sizes(kind, sizes)[0] == wrong


def test_sizes_that_make_a_body_are_none():
    assert not fault_of_sizes(CONE, (1, 1, 0)) and not fault_of_sizes(TUBE, (1, 1, 0.9))
