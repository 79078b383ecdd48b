"""A rigid open chain as a DAFMS deck: frames at the hinges, numbers as the columns of 1992 hold them.

Sequence and FORMATs: DAFMS thesis (Zhao, 1992), appendix C.  A body that turns about one or two axes of its
hinge gets axes that lie in those of P_k at the start, where all coordinates are 0; other bodies keep theirs.
"""

from collections.abc import Iterator, Sequence
from itertools import chain
from typing import Any

import numpy as np

from ....deck.dialogue import text_of
from ....deck.fortran_fields import filled
from ....deck.record import Number, Record
from ....deck.units import Units
from ....model.exchange.function_cards import FunctionCards
from ....model.exchange.functions import points_of, value_of
from ....model.exchange.rigid_model import Refusals, RigidModel, shifted
from ....model.joints import ANGLE
from ....model.laws import Element, Frames
from ....model.loads import AppliedTorque
from ....model.mechanism import GROUND
from ....model.shapes import KINDS
from ....model.vectors import euler_parameters
from ...elements_block.writer import BlockWriter, block, numbers
from ..cards import CARDS
from ..deck_writer import deck_lines
from .chain import FREE, Hanging, Link, chain_of, hinge_frame

_APART = 1e-9  # m: of the point of a force from O_k
_IMPLICIT = 2  # METH
_SAME_AXES = 1e-9
_ROUND_OFF = 1e-15  # m, of frames


def rigid_deck(model: RigidModel, title: str, units: Units) -> str:
    """Return the deck's text; raises ModelError with all that a tree of rigid bodies cannot have."""
    deck = _Deck(model)
    deck.refuse_foreign()
    records = deck.records(title) if not deck.refusals.items else []
    lines = deck.block() if not deck.refusals.items else []
    deck.refusals.raise_faults()
    rounding = f"Numbers are rounded to their columns, relatively by {deck.rounding:.1g} at most."
    notes = [f"Units: {units.reported}.", *(f"{note}." for note in model.notes), *deck.notes(), rounding]
    return text_of(deck_lines(records, lines)) + "".join(f"{note}\n" for note in notes)


class _Deck(BlockWriter):
    """Frames of the tree while its cards are made.

    `rounding`: the largest of numbers, relative; `number`: of bodies in the tree.
    """

    dialect, function_id = "DAFMS", "DAFMS-174"
    reserved = frozenset(card.section for card in CARDS.values())

    def __init__(self, model: RigidModel):
        self.model, self.refusals, self.rounding = model, Refusals(), 0.0
        self.functions = FunctionCards()
        self.links = chain_of(model, self.refusals)
        self.number = {link.body: k for k, link in enumerate(self.links, start=1)} | {GROUND: 0}
        self.hinge_of = {link.joint: k for k, link in enumerate(self.links, start=1)}
        self.hung: dict[int, Hanging] = {}

    def notes(self) -> Iterator[str]:
        """Return what the deck's reader should know of its bodies."""
        pairs = ", ".join(f"{k} is {link.body + 1}" for k, link in enumerate(self.links, start=1))
        yield f"Bodies here and in the order of the other deck: {pairs}."
        if self.model.points:
            yield "Points of interest are left out."
        if any(shape.file for shape in self.model.shapes):
            yield "Shapes of STL files are left out: DAFMS has primitives only."

    def refuse_foreign(self) -> None:
        """Collect what no tree of DAFMS has."""
        for joint in self.model.joints:
            if joint.kind not in FREE:
                self.refusals.add(joint, f"DAFMS has no hinge like a {joint.kind} joint", id="DAFMS-177")
        for item in self.model.drivers:
            self.refusals.add(
                item,
                "DAFMS prescribes hinge coordinates, not those of a body: drive the joint",
                id="DAFMS-178",
            )
        for item in (*self.model.forces, *self.model.torques):
            if item.following:
                self.refusals.add(item, "loads in DAFMS keep to inertial axes", id="DAFMS-179")
        for item in self.model.forces:
            if value_of(item.factor) is None:
                self.refusals.add(item, "forces in DAFMS are constant", id="DAFMS-180")

    def records(self, title: str) -> list[Record]:
        """Return the records of the deck in terms of the table of cards."""
        bodies = [self._hang(link) for link in self.links]
        return [
            self._record("title", 0, text=title),
            self._record("counts", 0, N=len(bodies), NDM=3, UNCO=0),
            self._record("time", 0, IT=self.model.time.rows - 1, H=self.model.time.step),
            *(self._hinge(k, hung) for k, hung in enumerate(bodies, start=1)),
            *self._bodies("MASS", [[self._own(hung).mass] for hung in bodies]),
            *self._inertia(bodies),
            *self._bodies("Q(k)", [hung.point for hung in bodies]),
            *self._bodies("EULT", [_scalar_last(hung.frame.T @ hung.own) for hung in bodies]),
            *self._bodies("EULL", [_scalar_last(self._parent(hung).T @ hung.frame) for hung in bodies]),
            *self._state(bodies),
            *self._bodies("RC(K", [self._centre(hung) for hung in bodies]),
            self._card("GRAV", 0, *self.model.gravity),
            *self._loads(bodies), *self._shapes(),
            *([] if self.model.integrator.method == "RK45" else [self._card("METH", 0, _IMPLICIT)]),
        ]  # fmt: skip

    def _record(self, section: str, number: int, **values: Any) -> Record:
        numbers = (Number(key, value, "", text=self._spelled(value)) for key, value in values.items())
        return Record(section, number, section, tuple(numbers))

    def _card(self, word: str, number: int, *values: Any) -> Record:
        """Return a record of a card; its values in the order of its items."""
        card = CARDS[word]
        keys = (item.key for item in card.items[word == "GRAV" :])  # the first of GRAV is not used
        return self._record(card.section, number, **dict(zip(keys, values, strict=True)))

    def _spelled(self, value: float | str) -> str:
        """Return the columns of a number; its rounding is kept for the notes."""
        if isinstance(value, int | str):
            return str(value)
        # Round-off of the frames would fill its columns by an exponent.
        value = 0.0 if abs(value) < _ROUND_OFF else float(value)
        text = filled(value, 10)
        self.rounding = max(self.rounding, abs(float(text) - value) / max(abs(value), 1e-3))
        return text

    def _hang(self, link: Link) -> Any:
        """Return the frames of a body, those of its parent being known."""
        model, body, axis = self.model, self.model.bodies[link.body], 3
        if link.joint is None:
            kind, origin, own, frame, place = "free", body.r, body.A, np.eye(3), np.zeros(3)
        else:
            joint = model.joints[link.joint]
            kind = joint.kind
            _, s, P, s_own = link.ends(joint)
            origin, place = (model.position(link.body, P),) * 2
            frame, axis = hinge_frame(kind, model.axes(link.parent), s, body.A, s_own)
            own = frame if kind in ("revolute", "universal", "cylindrical") else body.A
        if link.parent != GROUND:
            parent = self.hung[link.parent]
            place = parent.own.T @ (place - parent.origin)
        # A free body hangs at the origin, and its coordinates are its place.
        self.hung[link.body] = Hanging(link, kind, place, own, frame, origin, axis)
        return self.hung[link.body]

    def _own(self, hung: Hanging) -> Any:
        return self.model.bodies[hung.link.body]

    def _parent(self, hung: Hanging) -> Any:
        return np.eye(3) if hung.link.parent == GROUND else self.hung[hung.link.parent].own

    def _centre(self, hung: Hanging) -> Any:
        """Mass centre from O_k, axes of O_k."""
        body = self._own(hung)
        return hung.own.T @ (body.r + body.A @ body.centre - hung.origin)

    def _inertia(self, bodies: Sequence[Hanging]) -> Any:
        inertias = []
        for hung in bodies:
            body, c, turn = self._own(hung), self._centre(hung), hung.own.T @ self._own(hung).A
            inertias.append(turn @ body.inertia @ turn.T + body.mass * (c @ c * np.eye(3) - np.outer(c, c)))
        products = [[J[0, 1], J[0, 2], J[1, 2]] for J in inertias]
        cards = self._bodies("INER", [np.diag(J) for J in inertias])
        return cards + (self._bodies("PROD", products) if np.abs(products).max() > 1e-15 else [])

    def _state(self, bodies: Sequence[Hanging]) -> Any:
        """Speeds and coordinates: rotations of all bodies, then translations."""
        speeds, coordinates = [], []
        for turning in (True, False):
            for hung in bodies:
                axes = hung.free(0 if turning else 1)
                rates = hung.frame.T @ (self._turning(hung) if turning else self._sliding(hung))
                place = np.zeros(3) if turning or hung.kind != "free" else hung.origin
                speeds += [rates[axis - 1] for axis in axes]
                coordinates += [place[axis - 1] for axis in axes]
        pairs = enumerate(zip(speeds, coordinates, strict=True), start=1)
        return [self._record("state", m, u=u, q=q) for m, (u, q) in pairs]

    def _turning(self, hung: Hanging) -> Any:
        model, link = self.model, hung.link
        return model.angular_velocity(link.body) - model.angular_velocity(link.parent)

    def _sliding(self, hung: Hanging) -> Any:
        """Velocity of O_k against the point of the parent where it is, global axes."""
        model, link = self.model, hung.link
        velocity = 0.0
        for body, sign in ((link.body, 1.0), (link.parent, -1.0)):
            if body != GROUND:
                own = model.bodies[body]
                velocity = velocity + sign * (own.velocity + np.cross(own.omega, hung.origin - own.r))
        return velocity

    def _hinge(self, k: int, hung: Hanging) -> Record:
        """Return the parent of a body, and the flags of its free translations and rotations."""
        flags = {
            f"{letter}.{axis}": int(axis in hung.free(which))
            for which, letter in ((1, "NT"), (0, "NR"))
            for axis in (1, 2, 3)
        }
        return self._record("body", k, L=self.number[hung.link.parent], **flags)

    def _loads(self, bodies: Sequence[Hanging]) -> Any:
        """Constant forces at O_k and torques, then torques by tables."""
        forces, torques = np.zeros((len(bodies), 3)), np.zeros((len(bodies), 3))
        tables: list[Any] = []
        for item in self.model.forces:
            hung = self.hung[item.body]
            if np.linalg.norm(self.model.position(item.body, item.point) - hung.origin) > _APART:
                where = " ".join(f"{x:.9g}" for x in hung.origin)
                message = f"DAFMS has forces at the origin O_k of a body only, here at {where}"
                self.refusals.add(item, message, id="DAFMS-181")
            forces[self.number[item.body] - 1] += value_of(item.factor) * np.array(item.force)
        for item in self.model.torques:
            value, k = value_of(item.factor), self.number[item.body]
            if value is not None:
                torques[k - 1] += value * np.array(item.torque)
            else:
                tables += self._torque_tables(item, k)
        cards = [self._bodies(w, loads) for w, loads in (("FORC", forces), ("TOQU", torques)) if loads.any()]
        return [*chain.from_iterable(cards), *self._tables(tables)]

    def _tables(self, tables: Sequence[Any]) -> Iterator[Record]:
        """Yield the entries of card TABL; of each body, axis and points."""
        for n, (body, axis, points) in enumerate(tables, start=1):
            head = self._card("TABL", n, body, axis, len(points))
            yield head
            for i, (t, v) in enumerate(points, start=1):
                yield self._record(f"{head.section}.{n}", i, t=t, f=v)

    def _torque_tables(self, item: AppliedTorque, k: int) -> Any:
        points = self._points_at(item, item.factor)
        return [
            (k, axis, [(t, item.torque[axis - 1] * v) for t, v in points])
            for axis in (1, 2, 3)
            if item.torque[axis - 1]
        ]

    def _shapes(self) -> Iterator[Record]:
        """Yield primitives in the axes of O_k; DAFMS names no files."""
        shapes = (shape for shape in self.model.shapes if not shape.file)
        for n, shape in enumerate(shapes, start=1):
            if shape.body != GROUND:
                body, hung = self.model.bodies[shape.body], self.hung[shape.body]
                shape = shifted(shape, shape.body, hung.own.T @ (body.r - hung.origin), hung.own.T @ body.A)
            kind = KINDS.index(shape.kind) + 1
            numbers = *shape.sizes, *shape.offset, *shape.angles
            yield self._card("GEOM", n, self.number[shape.body], kind, *numbers)

    def _bodies(self, word: str, rows: Sequence[Any] | np.ndarray) -> list[Record]:
        """Return a record of a card for every body."""
        return [self._card(word, k, *map(float, row)) for k, row in enumerate(rows, start=1)]

    def block(self) -> list[str]:
        """Return the block of force elements, couplings and prescribed motions."""
        for item in self.model.elements:
            if isinstance(item.measure, Frames):
                self._check_axes(item)
        lines = self.element_lines()
        for driver in self.model.joint_drivers:
            lines.append(self.driver_line(driver, f"at={self.coordinate(driver.joint, driver.coordinate)}"))
        return block([*self.function_lines(), *lines])

    def coordinate(self, joint: int, coordinate: str) -> str:
        """Return the spelling of a coordinate."""
        hinge = self.hinge_of[joint]
        return f"{hinge}.{'r' if coordinate == ANGLE else 't'}{self.hung[self.links[hinge - 1].body].axis}"

    def joint(self, joint: int) -> int:
        """Return the number of the body on whose hinge a joint lies."""
        return self.hinge_of[joint]

    def end(self, body: int, point: Any) -> str:
        """Return the spelling of an end."""
        place = [0.0 if abs(x) < _ROUND_OFF else x for x in self._point(body, point)]
        return f"{0 if body == GROUND else self.number[body]}({numbers(place, ',')})"

    def _check_axes(self, item: Element) -> None:
        i = item.measure.i
        if i != GROUND and np.abs(self.hung[i].own - self.model.axes(i)).max() > _SAME_AXES:
            message = "a bushing acts along the axes of its first body, which DAFMS lays along its hinge"
            self.refusals.add(item, message, id="DAFMS-175")

    def _point(self, body: int, P: Any) -> Any:
        """A point from O_k, axes of O_k; of the ground from the origin."""
        place = self.model.position(body, P)
        if body == GROUND:
            return place
        hung = self.hung[body]
        return hung.own.T @ (place - hung.origin)

    def _points_at(self, item: AppliedTorque, function: Any) -> Any:
        """Return the points of a table; another function is refused."""
        points = points_of(function)
        if points is None:
            self.refusals.add(
                item,
                "only tables of loads are converted to DAFMS; give the function as TABLE",
                id="DAFMS-176",
            )
        return points or []


def _scalar_last(A: np.ndarray) -> Any:
    e0, *e = euler_parameters(A)
    return (*e, e0)
