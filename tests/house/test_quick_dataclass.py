"""Data classes defined without generated code: each behaves as that of the standard library does."""

import copy
import dataclasses
import pickle
from typing import Any

import pytest

from flexmb_cli import quick_dataclass

WAYS = {"standard": dataclasses, "quick": quick_dataclass}


def classes(way: Any) -> dict[str, type]:
    """The same classes, defined in one of the ways."""

    @way.dataclass(frozen=True)
    class Point:
        x: float
        y: float = 2.0
        names: list = way.field(default_factory=list)
        note: str = way.field(default="", compare=False)
        made: dict = way.field(default_factory=dict, init=False, repr=False, compare=False)

    @way.dataclass(frozen=True)
    class Named(Point):
        name: str = "none"

    @way.dataclass
    class Changing:
        x: int
        y: int = 0

        def __post_init__(self):
            self.sum = self.x + self.y

    @way.dataclass(frozen=True, eq=False)
    class Itself:
        x: int

        def __repr__(self):
            return "itself"

    return {"Point": Point, "Named": Named, "Changing": Changing, "Itself": Itself}


QUESTIONS = {
    "representation": lambda c: [repr(c["Point"](1)), repr(c["Named"](1, name="a")), repr(c["Itself"](1))],
    "positions and names": lambda c: vars(c["Named"](1, 5, names=[3], note="n")),
    "default of a factory is new": lambda c: c["Point"](1).names is c["Point"](1).names,
    "default in the class": lambda c: (c["Point"].y, hasattr(c["Point"], "names"), hasattr(c["Point"], "x")),
    "equality": lambda c: [c["Point"](1) == c["Point"](1, note="other"), c["Point"](1) == c["Point"](2)],
    "equality of kinds": lambda c: [c["Named"](1) == c["Point"](1), c["Point"](1) == (1, 2.0, [])],
    "identity": lambda c: [c["Itself"](1) == c["Itself"](1), len({c["Itself"](1), c["Itself"](1)})],
    "hash": lambda c: len({c["Point"](1, 2, ()), c["Point"](1, 2, (), "other"), c["Point"](1, 3, ())}),
    "no hash": lambda c: hash(c["Changing"](1)),
    "unhashable field": lambda c: hash(c["Point"](1)),
    "afterwards": lambda c: c["Changing"](2, 3).sum,
    "assignment": lambda c: setattr(c["Point"](1), "x", 2),
    "assignment of another name": lambda c: setattr(c["Named"](1), "z", 2),
    "deletion": lambda c: delattr(c["Point"](1), "x"),
    "change": lambda c: setattr(c["Changing"](1), "x", 2),
    "missing": lambda c: c["Point"](),
    "too many": lambda c: c["Changing"](1, 2, 3),
    "twice": lambda c: c["Changing"](1, x=2),
    "unknown": lambda c: c["Changing"](1, z=2),
    "not for the caller": lambda c: c["Point"](1, made={}),
    "copies": lambda c: [vars(copy.deepcopy(c["Point"](1))), vars(copy.copy(c["Changing"](1)))],
    "matching": lambda c: c["Named"].__match_args__,
    "known to the standard library": lambda c: (
        dataclasses.asdict(c["Named"](1)), dataclasses.is_dataclass(c["Named"]),
        [(one.name, one.type, one.init) for one in dataclasses.fields(c["Named"])],
    ),
    "replaced by the standard library": lambda c: vars(dataclasses.replace(c["Named"](1), x=7)),
    "a standard one above": lambda c: repr(
        dataclasses.make_dataclass("Above", [("z", int, 3)], bases=(c["Point"],), frozen=True)(1)
    ),
    "a changing one above": lambda c: dataclasses.make_dataclass("Above", ["z"], bases=(c["Named"],)),
}  # fmt: skip


def answer(question, way, objects):
    """What a question gives, or the class of its fault, when so many objects exist already."""
    defined = classes(WAYS[way])
    for _ in range(objects):
        [one(1) for one in defined.values()]
    try:
        return question(defined)
    except Exception as fault:
        return type(fault)


@pytest.mark.parametrize("objects", [0, quick_dataclass._MANY])
@pytest.mark.parametrize("name", QUESTIONS)
def test_a_quick_class_answers_as_a_standard_one(name, objects):
    assert answer(QUESTIONS[name], "quick", objects) == answer(QUESTIONS[name], "standard", objects)


def test_fields_and_copies():
    named = classes(quick_dataclass)["Named"]
    assert [one.name for one in quick_dataclass.fields(named)] == ["x", "y", "names", "note", "made", "name"]
    changed = quick_dataclass.replace(named(1, names=[4]), x=2, name="b")
    assert (changed.x, changed.names, changed.name) == (2, [4], "b")
    standard = classes(dataclasses)["Named"](1)
    assert quick_dataclass.replace(standard, x=2) == dataclasses.replace(standard, x=2)


@pytest.mark.parametrize("wrong", [[], {}])
def test_shared_defaults_are_refused(wrong):
    with pytest.raises(ValueError, match="default_factory"):
        quick_dataclass.dataclass(type("Shared", (), {"__annotations__": {"x": list}, "x": wrong}))


def test_a_base_of_the_standard_library_is_refused():
    """Its fields would be forgotten."""
    with pytest.raises(TypeError, match="of the standard library"):
        quick_dataclass.dataclass(type("Above", (classes(dataclasses)["Point"],), {"__annotations__": {}}))


@quick_dataclass.dataclass(frozen=True)
class Sent:
    """What one process hands to another."""

    x: int


def test_objects_are_sent_to_other_processes():
    assert pickle.loads(pickle.dumps(Sent(3))) == Sent(3)


def test_a_class_of_many_objects_gets_compiled_functions():
    defined = classes(quick_dataclass)["Changing"]
    first = defined.__init__
    [defined(k) for k in range(quick_dataclass._MANY)]
    assert defined.__init__ is not first
    assert (defined(1, 2) == defined(1, 2), defined(1, 2).sum) == (True, 3)
