"""Planar linkages in space, with closed forms: four-bar and slider-crank in the x-y plane.

Body 1 is the ground, body 2 the crank, turned about z through the origin by a driver; all estimates
are those of the closed form at the first time.  The coupler hangs on a spherical joint at the crank
and on a universal joint at the other end, so that no equation repeats another.
"""

import math
from dataclasses import dataclass

import numpy as np

from flexmb_cli.model.mechanism import Body, Driver, Ground, Joint, Mechanism, Simplified, TimeGrid
from tests.solvers.kinematics.geometry import euler_parameters

Z = (0.0, 0.0, 1.0)
GROUND = Body("body 1", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
AT_REST = Ground("ground 1", 0, (0.0,) * 6)


def turned_about_z(name, x, y, angle) -> Body:
    """A body at (x, y, 0), turned about z."""
    return Body(name, (float(x), float(y), 0.0), tuple(map(float, euler_parameters(Z, angle))))


def crank_held(body=1) -> tuple[Simplified, ...]:
    """The five coordinates of a crank about z that its driver leaves open."""
    return tuple(Simplified(f"simplified {k}", body, k, 0.0) for k in range(1, 6))


def coupler_joints(length, crank) -> tuple[Joint, ...]:
    """Coupler (body 3) from the crank's end to the universal joint at body 4's point (0, 0, 0)."""
    return (
        Joint("spherical", "spherical 1", 1, 2, (crank, 0.0, 0.0), (0.0, 0.0, 0.0)),
        Joint("universal", "universal 1", 2, 3, (length, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), Z),
    )


@dataclass(frozen=True)
class FourBar:
    """Lengths in m: crank from (0, 0), rocker from (ground, 0); `open` picks one of the two ways to close."""

    ground: float
    crank: float
    coupler: float
    rocker: float
    open: float = 1.0

    def rocker_angle(self, crank_angle):
        """Angle of the rocker, of its end seen from (ground, 0)."""
        ax, ay = self.crank * np.cos(crank_angle) - self.ground, self.crank * np.sin(crank_angle)
        square = ax * ax + ay * ay
        cosine = (square + self.rocker**2 - self.coupler**2) / (2.0 * self.rocker * np.sqrt(square))
        return np.arctan2(ay, ax) - self.open * np.arccos(cosine)

    def rocker_end(self, crank_angle):
        """The joint between coupler and rocker (…, 2)."""
        angle = self.rocker_angle(crank_angle)
        return np.stack([self.ground + self.rocker * np.cos(angle), self.rocker * np.sin(angle)], -1)

    def mechanism(self, function, time: TimeGrid) -> Mechanism:
        """Driven by law = (C, B, A); body 4, the rocker, has its origin at its moving end."""
        C, B, A = function
        angle = C + B * time.start + 0.5 * A * time.start**2
        end = self.rocker_end(angle)
        rocker = float(self.rocker_angle(angle))
        pin = self.crank * np.array([math.cos(angle), math.sin(angle)])
        bodies = (
            GROUND,
            turned_about_z("body 2", 0.0, 0.0, angle),
            turned_about_z("body 3", *pin, math.atan2(*(end - pin)[::-1])),
            turned_about_z("body 4", *end, rocker),
        )
        pivot = Joint("revolute", "revolute 1", 0, 3, (self.ground, 0.0, 0.0), (-self.rocker, 0.0, 0.0), Z, Z)
        return Mechanism(
            bodies,
            time,
            (*coupler_joints(self.coupler, self.crank), pivot),
            crank_held(),
            drivers=(Driver("driver 1", 1, 6, C, B, A),),
            grounds=(AT_REST,),
        )


@dataclass(frozen=True)
class SliderCrank:
    """Crank and rod, m; the slider (body 4) moves along x, at x = r cos φ + √(l² - r² sin² φ)."""

    crank: float
    rod: float

    def slide(self, angle):
        """x of the slider."""
        return self.crank * np.cos(angle) + np.sqrt(self.rod**2 - (self.crank * np.sin(angle)) ** 2)

    def mechanism(self, function, time: TimeGrid, driven="crank", angle=None) -> Mechanism:
        """Driven by law = (C, B, A): the crank about z, or the slider along x from crank angle `angle`."""
        C, B, A = function
        angle = C + B * time.start + 0.5 * A * time.start**2 if angle is None else angle
        pin = self.crank * np.array([math.cos(angle), math.sin(angle)])
        slide = float(self.slide(angle))
        bodies = (
            GROUND,
            turned_about_z("body 2", 0.0, 0.0, angle),
            turned_about_z("body 3", *pin, math.atan2(-pin[1], slide - pin[0])),
            turned_about_z("body 4", slide, 0.0, 0.0),
        )
        guide = Joint(
            "translational",
            "translational 1",
            0,
            3,
            (0.0, 0.0, 0.0),
            (0.0, 0.0, 0.0),
            (1.0, 0.0, 0.0),
            (1.0, 0.0, 0.0),
            (0.0, 1.0, 0.0),
            Z,
        )
        joints = (*coupler_joints(self.rod, self.crank), guide)
        if driven == "crank":
            held, driver = crank_held(), Driver("driver 1", 1, 6, C, B, A)
        else:
            axle = Joint("revolute", "revolute 1", 0, 1, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), Z, Z)
            joints, held = (*joints[:2], axle, guide), ()
            driver = Driver("driver 1", 3, 1, C, B, A)
        return Mechanism(bodies, time, joints, held, drivers=(driver,), grounds=(AT_REST,))
