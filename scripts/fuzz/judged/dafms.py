"""Judges the rows of a DAFMS deck by the deck's own numbers: its masses, stiffness, springs and weights.

Nodes are mass points on their body, what they leave of its mass sits at its origin (decks/dafms/FORMAT.md).
"""

import numpy as np

from .rows import Bodies, Verdict, small
from .vsdf import same_energy

# Cards that store energy, or change what the energies mean, and are not read here.
STORING = {"ELEM"}  # the block ELEMENTS


def judge_dafms(result, text, judged: list[str]) -> None:
    """Raise Verdict where the rows contradict the deck; `judged` gets what could not be judged."""
    judged += [f"not judged: DAFMS {word}" for word in text.unread]
    _time(result, text)
    motion = _Motion(result, text)
    points = [point for body in motion.numbers for point in motion.points(body)]
    weights = [-mass * place @ text.gravity for mass, place, _ in points]
    if STORING & set(text.unread):
        judged.append("not judged: DAFMS potential energy")
    elif text.springs and any(sum(flags) == 3 for flags in text.rotations):
        judged.append("not judged: DAFMS SPRI beside three rotations")
    else:
        springs = [_spring(result, text, spring) for spring in text.springs]
        same_energy("potential energy", result["energy/potential"], [*weights, *springs])
    same_energy("kinetic energy", result["energy/kinetic"], motion.kinetic(points), absolute=True)
    same_energy("strain energy", result["energy/strain"], motion.strains(), absolute=True)


def _time(result, text):
    found = result["time"]
    if len(found) != text.rows + 1:
        raise Verdict(f"{len(found)} rows, the deck has {text.rows + 1}")
    small("times", found - text.interval * np.arange(len(found)), found)


class _Motion:
    """Mass points of the bodies, and their elastic coordinates."""

    def __init__(self, result, text):
        self.result, self.text, self.bodies = result, text, Bodies(result)
        self.numbers = range(1, len(text.nodes) + 1)

    def card(self, word, body, count):
        """Return the numbers of a card for a body; what is not given is 0."""
        return np.array(self.text.cards.get(word, {}).get(body, [0.0] * count))

    def elastic(self, body, name):
        """Return elastic coordinates or speeds of a body, (time, node, 3)."""
        free = self.text.freedoms[body - 1]
        sizes = [n * f for n, f in zip(self.text.nodes, self.text.freedoms, strict=True)]
        values = self.result[name]
        start = values.shape[1] - sum(sizes[body - 1 :])
        nodes = self.text.nodes[body - 1]
        found = np.zeros((len(values), nodes, 3))
        found[..., 3 - free :] = values[:, start : start + nodes * free].reshape(-1, nodes, free)
        return found

    def points(self, body):
        """Return (mass, place, velocity) of the mass centre, or of the origin and the nodes."""
        mass = self.card("MASS", body, 1)[0]
        if body not in self.text.elastic:
            return [(mass, *self.bodies.point(body, self.card("RC(K", body, 3))[:2])]
        places, _, masses = self.text.elastic[body]
        found = [(mass - masses.sum(), self.bodies.r[:, body - 1], self.bodies.v[:, body - 1])]
        bent, rate = (self.elastic(body, name) for name in ("coordinate/q", "coordinate/u"))
        axes = np.stack([self.bodies.vector(body, unit)[0] for unit in np.eye(3)], -1)
        for k in range(len(masses)):
            arm = np.einsum("tij,tj->ti", axes, places[k] + bent[:, k])
            speed = np.cross(self.bodies.omega[:, body - 1], arm) + np.einsum("tij,tj->ti", axes, rate[:, k])
            found.append((masses[k], found[0][1] + arm, found[0][2] + speed))
        return found

    def kinetic(self, points):
        """Return the parts of the kinetic energy: points, and what turns about them."""
        found = [0.5 * mass * (speed**2).sum(-1) for mass, _, speed in points]
        for body in self.numbers:
            axes = np.stack([self.bodies.vector(body, unit)[0] for unit in np.eye(3)], -1)
            omega = np.einsum("tji,tj->ti", axes, self.bodies.omega[:, body - 1])
            found.append(0.5 * np.einsum("ti,ij,tj->t", omega, self._inertia(body), omega))
        return found

    def _inertia(self, body):
        """Return the inertia about O_k less that of the mass points."""
        inertia = np.diag(self.card("INER", body, 3))
        one_two, one_three, two_three = self.card("PROD", body, 3)
        inertia[0, 1] = inertia[1, 0] = one_two
        inertia[0, 2] = inertia[2, 0] = one_three
        inertia[1, 2] = inertia[2, 1] = two_three
        if body in self.text.elastic:
            places, _, masses = self.text.elastic[body]
        else:
            places, masses = [self.card("RC(K", body, 3)], self.card("MASS", body, 1)
        for place, mass in zip(places, masses, strict=True):
            inertia = inertia - mass * (place @ place * np.eye(3) - np.outer(place, place))
        return inertia

    def strains(self):
        """Return ½ q K q of every elastic body."""
        found = []
        for body, (_, stiffness, _) in self.text.elastic.items():
            bent = self.elastic(body, "coordinate/q")[..., 3 - self.text.freedoms[body - 1] :]
            bent = bent.reshape(len(bent), -1)
            found.append(0.5 * np.einsum("ti,ij,tj->t", bent, stiffness, bent))
        return found


def _spring(result, text, spring):
    """Return ½ k (q - q0)² of a hinge spring."""
    body, axis, stiffness, rest = spring
    kinds = text.rotations if axis <= 3 else text.translations
    before = sum(map(sum, text.rotations)) if axis > 3 else 0
    before += sum(map(sum, kinds[: body - 1])) + sum(kinds[body - 1][: (axis - 1) % 3])
    return 0.5 * stiffness * (result["coordinate/q"][:, before] - rest) ** 2
