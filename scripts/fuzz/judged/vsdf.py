"""Judges the rows of a VSDF deck by the deck's own numbers: gaps of joints, energies."""

import numpy as np
import scipy.io

from .rows import Bodies, Verdict

OPEN = 1e-6  # of the mechanism's size: each step is projected to 1e-10, decks round their points to 1e-7
PARTS = 1e-5  # of an energy's largest part: digits of the decks and of the matrices
# Cards that store energy and are not read here.
STORING = {"ELEM", "JSPR"}  # the block ELEMENTS
CLOSED = ("SPHE", "UNIV", "REVO", "FIXD")
AXIAL = ("REVO", "CYLI", "TRAN", "SCRW")
SLIDING = ("CYLI", "TRAN", "SCRW")


def judge_vsdf(result, text, judged: list[str]) -> None:
    """Raise Verdict where the rows contradict the deck; `judged` gets what could not be judged."""
    judged += [f"not judged: VSDF {word}" for word in text.unread]
    motion = _Motion(result, text)
    for fields in text.get("JOIN"):
        _joint(motion, fields, judged)
    _potential(motion, text, judged)
    _kinetic(motion, text, judged)


class _Motion:
    """What the nodes of rigid and flexible bodies do."""

    def __init__(self, result, text):
        self.result, self.bodies = result, Bodies(result)
        self.kinds = {card[0]: card[1].upper() for card in text.get("BODY")}
        self.nodes = {(card[0], card[1]): np.array(_filled(card[2:])) for card in text.get("NODE")}
        self.span = 1.0 + np.abs(self.bodies.r).max()

    def turning(self, body):
        """Return the rotation matrices of a body, (time, 3, 3), body axes to global ones."""
        return np.stack([self.bodies.vector(body, unit)[0] for unit in np.eye(3)], -1)

    def local(self, body, node):
        """Return a node in the axes of its body over time; None for a node set, or of the other body."""
        if self.kinds.get(body) != "FLEX":
            at = self.nodes.get((body, node))
            return None if at is None else np.broadcast_to(at, self.bodies.r[:, 0].shape)
        numbers = self.result[f"elastic/body {body}/node"]
        return self.deformed(body)[:, numbers == node][:, 0] if node in numbers else None

    def deformed(self, body):
        """Return all nodes of a flexible body in its axes, (time, node, 3)."""
        shape = self.result[f"elastic/body {body}/shape"]
        amplitude = self.result[f"modal/body {body}/amplitude"]
        return self.result[f"elastic/body {body}/node_position"] + np.einsum("nam,tm->tna", shape, amplitude)

    def place(self, body, node):
        """Return a node in global axes, or None."""
        local = self.local(body, node)
        if local is None or body == 0:
            return local
        return self.bodies.r[:, body - 1] + np.einsum("tij,tj->ti", self.turning(body), local)


def _filled(values):
    return [0.0 if value is None else value for value in values]


def _joint(motion, fields, judged):
    number, kind, a, a1, a2, b, b1, b2 = fields[:8]
    kind = kind.upper()
    one, one_2 = _ends(motion, (a, a1, a2), (b, b1, b2))
    other, other_2 = _ends(motion, (b, b1, b2), (a, a1, a2))
    if one is None or other is None or kind not in (*CLOSED, *SLIDING, "DIST"):
        judged.append(f"not judged: VSDF {kind} joint, its gap")
        return
    name, apart = f"joint {number} ({kind})", other - one
    if kind in CLOSED:
        _closed(f"gap of {name}", apart, motion.span)
    if kind == "DIST":
        length = np.linalg.norm(apart, axis=-1)
        _closed(
            f"distance of {name}", length - (length[0] if fields[10] is None else fields[10]), motion.span
        )
    if kind not in AXIAL:
        return
    if one_2 is None or other_2 is None:
        judged.append(f"not judged: VSDF {kind} joint, its axis")
        return
    u, w = (_unit(end - start) for start, end in ((one, one_2), (other, other_2)))
    # The axis of a flexible body bends; its joint holds the frames or the nodes, which its kind tells.
    if "FLEX" not in (motion.kinds.get(a), motion.kinds.get(b)):
        _closed(f"axes of {name}", np.cross(u, w), 1.0)
    if kind in SLIDING:
        _closed(f"line of {name}", np.cross(u, apart), motion.span)


def _ends(motion, own, others):
    """Return the two points of a joint on one side; the ground's, without nodes, are the other's at first."""
    body, *nodes = own
    if body or nodes[0]:
        return [motion.place(body, node) for node in nodes]
    found = [motion.place(others[0], node) for node in others[1:]]
    return [None if at is None else np.broadcast_to(at[0], at.shape) for at in found]


def _unit(vector):
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True)


def _closed(what, gap, span):
    gap = np.abs(gap).reshape(len(gap), -1).max(axis=1)
    if (gap > OPEN * span).any():
        raise Verdict(f"{what}: {gap.max():.3g} at row {int(np.argmax(gap))}, size {span:.3g}")


def _masses(motion, text, judged):
    """Return (body, mass of a rigid body's card or matrix of a flexible one's file), or None."""
    found = {card[0]: card for card in text.get("RIGI")}
    for body, form, path in text.get("FEMM"):
        if form.upper() == "MM":
            found[body] = scipy.io.mmread(text.folder / path.replace("\\", "/")).tocsr()
    missing = set(motion.kinds) - set(found)
    judged += [f"not judged: VSDF masses of a {motion.kinds[body]} body, its file" for body in missing]
    return None if missing else found


def _potential(motion, text, judged):
    """Weights and springs make the potential energy: -Σ m g·r + ½ k (s - s0)²."""
    if STORING & set(text.unread):
        judged.append("not judged: VSDF potential energy")
        return
    gravity = np.sum([_filled(card) for card in text.get("GRAV")] or [np.zeros(3)], axis=0)
    masses = _masses(motion, text, judged) if gravity.any() else {}
    if masses is None:
        return
    parts = [-_moment(motion, body, mass) @ gravity for body, mass in masses.items()]
    for spring in text.get("SPRI"):
        stored = _stored(motion, spring)
        if stored is None:
            judged.append("not judged: VSDF SPRI")
            return
        parts.append(stored)
    same_energy("potential energy", motion.result["energy/potential"], parts)


def _moment(motion, body, mass):
    """Return Σ m r of a body, (time, 3)."""
    r = motion.bodies.r[:, body - 1]
    if isinstance(mass, list):
        return mass[1] * motion.bodies.point(body, np.array(_filled(mass[2:5])))[0]
    weights = np.asarray(mass.sum(axis=0)).ravel()[::3] if mass.shape[0] else np.zeros(0)
    local = np.einsum("n,tna->ta", weights, motion.deformed(body))
    return weights.sum() * r + np.einsum("tij,tj->ti", motion.turning(body), local)


def _stored(motion, spring):
    _, a, node_a, b, node_b, stiffness, _, rest = spring
    one, other = motion.place(a, node_a), motion.place(b, node_b)
    if one is None or other is None or rest is None:
        return None
    return 0.5 * (stiffness or 0.0) * (np.linalg.norm(other - one, axis=-1) - rest) ** 2


def _kinetic(motion, text, judged):
    """Velocities of the masses make the kinetic energy."""
    masses = _masses(motion, text, judged)
    if masses is None:
        return
    flexible = [body for body, kind in motion.kinds.items() if kind == "FLEX"]
    if any(f"modal/body {body}/rate" not in motion.result for body in flexible):
        judged.append("not judged: VSDF kinetic energy, modal rates not kept")
        return
    parts = [_moving(motion, body, mass) for body, mass in masses.items()]
    same_energy("kinetic energy", motion.result["energy/kinetic"], parts, absolute=True)


def _moving(motion, body, mass):
    """Return ½ m v² + ½ ω J ω, or ½ v M v of the nodes in the axes of the body."""
    turning, omega = motion.turning(body), motion.bodies.omega[:, body - 1]
    omega = np.einsum("tji,tj->ti", turning, omega)
    if isinstance(mass, list):
        speed = motion.bodies.point(body, np.array(_filled(mass[2:5])))[1]
        xx, yy, zz, xy, yz, zx = _filled(mass[5:11])
        inertia = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
        return 0.5 * mass[1] * (speed**2).sum(-1) + 0.5 * np.einsum("ti,ij,tj->t", omega, inertia, omega)
    local = np.einsum("tji,tj->ti", turning, motion.bodies.v[:, body - 1])
    shape, rate = motion.result[f"elastic/body {body}/shape"], motion.result[f"modal/body {body}/rate"]
    speed = local[:, None] + np.cross(omega[:, None], motion.deformed(body))
    speed = (speed + np.einsum("nam,tm->tna", shape, rate)).reshape(len(local), -1)
    return 0.5 * (speed * (mass @ speed.T).T).sum(-1)


def same_energy(what, stated, parts, absolute: bool = False):
    """Refuse an energy whose changes or (`absolute`) values are not those of its parts."""
    made = np.sum(parts, axis=0) + np.zeros(len(stated))
    size = max((np.ptp(part) for part in parts), default=0.0) + np.ptp(stated)
    gap = (stated - made) if absolute else (stated - stated[0]) - (made - made[0])
    round_off = 1e-12 * sum(np.abs(part).max() for part in parts) if parts else 0.0
    if np.abs(gap).max() > PARTS * size + round_off + 1e-12:
        worst = int(np.argmax(np.abs(gap)))
        raise Verdict(f"{what}: {gap[worst]:.3g} beside that of the deck at row {worst}, size {size:.3g}")
