"""A Deck to a mechanism with masses: the ground, and a bob that turns about z."""

from math import cos, pi, sin

from flexmb_cli.model.integrators import Integrator
from flexmb_cli.model.loads import DynamicModel, MassProperties
from flexmb_cli.model.mechanism import Body, Ground, Joint, Mechanism, Point, TimeGrid

Z = (0.0, 0.0, 1.0)


def build(deck, folder):
    bob = deck.one("bob")
    half, end = (bob["angle"] - pi / 2) / 2, (bob["length"], 0.0, 0.0)
    origin = (0.0, 0.0, 0.0)
    mechanism = Mechanism(
        (Body("ground", origin, (1.0, 0.0, 0.0, 0.0)), Body("bob", origin, (cos(half), 0.0, 0.0, sin(half)))),
        TimeGrid(0.0, bob["end"], bob["step"]),
        joints=(Joint("revolute", "pivot", 0, 1, origin, origin, Z, Z),),
        grounds=(Ground("ground", 0, (0.0,) * 6),),
        points=(Point("end", 1, end),),
    )
    mass = MassProperties("mass", 1, bob["mass"], end)
    return DynamicModel(
        mechanism, masses=(mass,), gravity=(0.0, -9.81, 0.0), integrator=Integrator(tolerance=1e-11)
    ), []
