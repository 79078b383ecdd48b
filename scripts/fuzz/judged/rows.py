"""The rows of a result, and what its bodies do at their points: only numpy and h5py compute here."""

import h5py
import numpy as np

ROUND_OFF = 1e-7  # of the size of what is compared: the solver's own limit is 1e-10 or less


class Verdict(Exception):
    """A result that contradicts its deck or itself."""


class Result:
    """The rows of an HDF5 file."""

    def __init__(self, path):
        with h5py.File(path) as file:
            self.attributes = dict(file.attrs)
            self.data, self.names = {}, {}
            file.visititems(self._take)

    def _take(self, name, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fi":
            self.data[name] = item[()]
        elif isinstance(item, h5py.Dataset) and name.endswith("/name"):
            self.names[name] = list(item.asstr()[()])

    def __getitem__(self, name):
        return self.data[name]

    def __contains__(self, name):
        return name in self.data

    @property
    def complete(self) -> bool:
        """Whether the run came to its end."""
        return self.attributes["status"] == "complete"


def small(what, gap, size):
    """Refuse a gap beyond round-off of `size`, both along time first."""
    gap = np.abs(np.asarray(gap, float)).reshape(len(gap), -1).max(axis=1, initial=0.0)
    size = np.abs(np.asarray(size, float)).reshape(len(gap), -1).max(axis=1, initial=0.0)
    bad = gap > ROUND_OFF * (1.0 + size)
    if bad.any():
        k = int(np.argmax(bad))
        raise Verdict(f"{what}: {gap[k]:.3g} at row {k}, size {size[k]:.3g}")


class Bodies:
    """Vectors and points of the bodies over time; body 0 is the ground."""

    def __init__(self, result):
        self.r, self.v, self.a = (result[f"body/{name}"] for name in ("position", "velocity", "acceleration"))
        self.p = result["body/euler_parameters"]
        self.omega, self.alpha = result["body/angular_velocity"], result["body/angular_acceleration"]

    def vector(self, body, s):
        """A vector of the body and its two derivatives, (time, 3) each."""
        if body == 0:
            fixed = np.broadcast_to(np.asarray(s, float), self.r[:, 0].shape)
            return fixed, 0 * fixed, 0 * fixed
        k = body - 1
        e0, e = self.p[:, k, :1], self.p[:, k, 1:]
        u = s + 2 * np.cross(e, np.cross(e, s) + e0 * s)
        ud = np.cross(self.omega[:, k], u)
        return u, ud, np.cross(self.alpha[:, k], u) + np.cross(self.omega[:, k], ud)

    def spin(self, body):
        """The angular velocity of a body, (time, 3)."""
        return self.omega[:, body - 1] if body else 0 * self.r[:, 0]

    def point(self, body, s):
        """A point of the body, its velocity and acceleration."""
        found = self.vector(body, s)
        if body == 0:
            return found
        origin = self.r[:, body - 1], self.v[:, body - 1], self.a[:, body - 1]
        return tuple(one + other for one, other in zip(origin, found, strict=True))
