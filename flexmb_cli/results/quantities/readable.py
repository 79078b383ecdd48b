"""Names of quantities as people write them: "velocity x of body 3", "kinetic energy"."""

from dataclasses import dataclass

from .quantities import Quantity

# The quantity of names that leave it out: body.3.z is a position.
_LEFT_OUT = {"body": "position", "point": "position", "coordinate": "coordinate", "elastic": "displacement"}
_WORDS = {
    "omega": "angular velocity",
    "alpha": "angular acceleration",
    "von_mises": "von Mises stress",
    "energy": "strain energy",
    "u": "speed",
    "u_rate": "acceleration",
}
_AXES = ("x", "y", "z")
# Quantities that the name of a component implies.
_IMPLIED = ("position", "Euler parameters")
_OF_BODY = ("stress", "strain", "elastic", "modal")


@dataclass(frozen=True)
class Readable:
    """Parts of a name: the quantity, its object, and its axis; "" for a missing part."""

    quantity: str
    thing: str
    component: str

    @property
    def label(self) -> str:
        """Return quantity, component and object in words: "velocity x of body 3", "z of point 1"."""
        head = self.quantity
        if self.component:
            head = self.component if head in _IMPLIED else f"{head} {self.component}"
        if head == "coordinate":
            return self.thing
        return f"{head} of {self.thing}" if self.thing else head


def readable(quantity: Quantity) -> Readable:
    """Return the words for a quantity; things have the names that the result gives them."""
    group, *words = quantity.name.split(".")
    if group == "energy":
        what = words[0].replace("_", " ")
        return Readable(what if what.startswith("applied") else f"{what} energy", "", "")
    if group == "audit":
        return Readable(words[0].replace("_", " "), "", "")
    if group in _OF_BODY:
        return _of_body(group, words)
    if not words:
        return Readable(group, "", "")
    named = quantity.long_name.partition(": ")[0] if ": " in quantity.long_name else f"{group} {words[0]}"
    return _of_thing(group, named, words[1:])


def _of_thing(group: str, named: str, words: list[str]) -> Readable:
    if not words:
        return Readable(_LEFT_OUT.get(group, group), named, "")
    if len(words) == 1 and group in ("body", "point"):
        return Readable("position" if words[0] in _AXES else "Euler parameters", named, words[0])
    *quantity, last = words
    if not quantity:
        return Readable(_word(last), named, "")
    return Readable(" ".join(map(_word, quantity)), named, last)


def _of_body(group: str, words: list[str]) -> Readable:
    """stress.2.node45.xx, strain.2.element3.energy, stress.2.max.von_mises, modal.1.amplitude.2."""
    body, *rest = words
    if group == "modal":
        return Readable(rest[0].replace("_", " "), f"mode {rest[-1]} of body {body}", "")
    place, *quantity = rest
    place = place.replace("node", "node ").replace("element", "element ")
    thing = f"body {body} {place}"
    if place == "max":
        head = (
            "node of the largest von Mises stress"
            if quantity[0] == "node"
            else f"largest {_word(quantity[0])}"
        )
        return Readable(head, f"body {body}", "")
    if quantity[0] == "principal":
        return Readable(f"principal {group}", thing, quantity[-1])
    if len(quantity) == 1 and quantity[0] in _WORDS:
        return Readable(_WORDS[quantity[0]], thing, "")
    return Readable(
        _word(quantity[0]) if len(quantity) > 1 else _LEFT_OUT.get(group, group), thing, quantity[-1]
    )


def _word(word: str) -> str:
    return _WORDS.get(word, word.replace("_", " "))
