"""Andrews' squeezer as a spatial mechanism: seven bodies, ten revolute joints, 50 equations of rank 41.

Data: Schiehlen (ed.), Multibody Systems Handbook (1990); Hairer and Wanner, Solving Ordinary
Differential Equations II, section VII.7; Test Set for IVP Solvers, problem II-10.  The mass centres
are those of the mass matrix printed there; the accelerations at the start confirm them.
"""

import math

import numpy as np

from flexmb_cli.model import laws
from flexmb_cli.model.loads import AppliedTorque, DynamicModel, MassProperties
from flexmb_cli.model.mechanism import Body, Joint, Mechanism, TimeGrid
from tests.solvers.constrained.dynamic_runs import AT_REST, GROUND

XA, YA, XB, YB, XC, YC = -0.06934, -0.00227, -0.03635, 0.03273, 0.014, 0.072
D, DA, E, EA, RR, RA = 0.028, 0.0115, 0.02, 0.01421, 0.007, 0.00092
SS, SA, SB, SC, SD, ZF, FA = 0.035, 0.01874, 0.01043, 0.018, 0.02, 0.02, 0.01421
ZT, TA, TB, U, UA, UB = 0.04, 0.02308, 0.00916, 0.04, 0.01228, 0.00449
MASSES = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)
INERTIAS = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)
STIFFNESS, FREE_LENGTH, MOMENT = 4530.0, 0.07785, 0.033

# beta, theta, gamma, phi, delta, omega, epsilon: at the start, and position and velocity at 0.03 s
# (computed there with tolerance 1e-14).
START = (
    -0.0617138900142764496, 0.0, 0.455279819163070380, 0.222668390165885885,
    0.487364979543842550, -0.222668390165885885, 1.23054744454982119,
)  # fmt: skip
END = (
    15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948,
    0.5244099658805304, 0.5347301163226948, 1.048080741042263,
)  # fmt: skip
END_RATES = (
    1139.920302151208, -1424.379294994111, 11.03291221937134, 19.29337464421385,
    0.5735699284790808, -19.29337464421385, 0.3231791658026955,
)  # fmt: skip
START_ACCELERATIONS = (14222.4439199541139, -10666.8329399655854)


def absolute(angles):
    """Angles of the seven bodies from the relative ones, also for rates."""
    beta, theta, gamma, phi, delta, omega, epsilon = angles
    return np.array([beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon])


def model(end, step) -> DynamicModel:
    """The squeezer from its start at rest."""
    b, _, _, _, d, _, ep = absolute(START)
    pin = RR * np.array([math.cos(b), math.sin(b)])
    origins = (
        (0.0, 0.0),
        pin,
        (XB, YB),
        (XA + ZT * math.cos(d), YA + ZT * math.sin(d)),
        (XA, YA),
        (XA + U * math.sin(ep), YA - U * math.cos(ep)),
        (XA, YA),
    )
    bodies = [GROUND]
    for number, ((x, y), angle) in enumerate(zip(origins, absolute(START), strict=True), start=2):
        p = (math.cos(0.5 * angle), 0.0, 0.0, math.sin(0.5 * angle))
        bodies.append(Body(f"body {number}", (float(x), float(y), 0.0), p))
    mechanism = Mechanism(tuple(bodies), TimeGrid(0.0, end, step), tuple(_joints()), grounds=(AT_REST,))
    spring = laws.spring("spring 1", laws.Line(0, 3, (XC, YC, 0.0), (SD, -SC, 0.0)), STIFFNESS, FREE_LENGTH)
    torque = AppliedTorque("torque 1", 1, (0.0, 0.0, MOMENT))
    return DynamicModel(mechanism, "forward", tuple(_masses()), torques=(torque,), springs=(spring,))


def _joints():
    pairs = (
        (0, 1, (0.0, 0.0), (0.0, 0.0)),
        (1, 2, (RR, 0.0), (0.0, 0.0)),
        (0, 3, (XB, YB), (0.0, 0.0)),
        (0, 5, (XA, YA), (0.0, 0.0)),
        (0, 7, (XA, YA), (0.0, 0.0)),
        (5, 4, (ZT, 0.0), (0.0, 0.0)),
        (7, 6, (0.0, -U), (0.0, 0.0)),
        (2, 3, (-D, 0.0), (0.0, -SS)),
        (2, 4, (-D, 0.0), (0.0, -E)),
        (2, 6, (-D, 0.0), (ZF, 0.0)),
    )
    axis = (0.0, 0.0, 1.0)
    for number, (i, j, P_i, P_j) in enumerate(pairs, start=1):
        yield Joint("revolute", f"revolute {number}", i, j, (*P_i, 0.0), (*P_j, 0.0), axis, axis)


def _masses():
    centres = (
        (RA, 0.0), (-DA, 0.0), (SB, -SA), (0.0, EA - E), (TA, TB), (ZF - FA, 0.0), (UB, -UA),
    )  # fmt: skip
    for k, (x, y) in enumerate(centres):
        I = INERTIAS[k]
        yield MassProperties(
            f"mass {k + 1}", k + 1, MASSES[k], (x, y, 0.0), (0.6 * I, 0.6 * I, I, 0.0, 0.0, 0.0)
        )
