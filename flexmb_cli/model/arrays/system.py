"""Arrays of a mechanism for the kernels of constrained dynamics, and the names that go with them."""

from dataclasses import dataclass, field

import numpy as np

from ..joints import Equation
from .contacts import Contacts
from .records import LOAD
from .signals import Signals, signal_arrays

SPEEDS_OF_BODY = ("vx", "vy", "vz", "ωx", "ωy", "ωz")


@dataclass(frozen=True)
class SystemArrays:
    """A mechanism of b bodies with m equations, E modal coordinates and n = 6 b + E speeds.

    Records are those of `records`; the rows of `constraints` come before those of `primitives`.
    """

    body_names: tuple[str, ...]
    equations: tuple[Equation, ...]  # (m,)
    q: np.ndarray  # (n + b,) estimates at the start
    angles: np.ndarray  # (angles,) estimates of the angles that count turns, rad
    coordinate_scale: np.ndarray  # (n + b,) units
    speed_scale: np.ndarray  # (n,)
    row_scale: np.ndarray  # (m,)
    constraints: np.ndarray  # CONSTRAINT
    bodies_of: np.ndarray  # (rows of constraints, 2)
    groups: np.ndarray  # GROUP
    joint_vectors: np.ndarray  # BODY_VECTOR of joint coordinates, which only report rows hold
    joint_coordinates: np.ndarray  # PRIMITIVE
    masses: np.ndarray  # (b,) MASS
    flexible: np.ndarray  # FLEXIBLE
    modal: np.ndarray  # their invariants
    body_vectors: np.ndarray  # BODY_VECTOR
    shapes: np.ndarray
    primitives: np.ndarray  # PRIMITIVE: first of the rows after those of `constraints`, then of springs
    loads: np.ndarray  # LOAD
    functions: np.ndarray  # FUNCTION
    knots: np.ndarray  # (k, 3)
    gravity: np.ndarray  # (3,) global axes, m/s²
    contacts: Contacts  # of its loads
    sensors: np.ndarray = field(kw_only=True, default_factory=lambda: np.zeros(0, LOAD))  # LOAD, of sensors
    signals: Signals = field(kw_only=True, default_factory=lambda: signal_arrays(()))

    @property
    def bodies(self) -> int:
        """Number of bodies."""
        return len(self.masses)

    @property
    def speeds(self) -> int:
        """Number of speeds."""
        return self.speed_scale.size

    @property
    def place_of_work(self) -> int:
        """Return the place of the work of drivers and loads in a state."""
        return 2 * self.speeds + self.bodies + len(self.signals.states)

    def speed_name(self, k: int) -> str:
        """Readable name of a speed, such as "body 2 vx" or "body 1 mode 3"."""
        if k < 6 * self.bodies:
            return f"{self.body_names[k // 6]} {SPEEDS_OF_BODY[k % 6]}"
        for f in self.flexible:
            mode = k - 6 * self.bodies - f["first"]
            if 0 <= mode < f["modes"]:
                return f"{self.body_names[f['body']]} mode {mode + 1}"
        raise IndexError(k)
