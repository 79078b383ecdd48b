"""Data classes like those of the standard library, defined forty times as fast.

`dataclasses.dataclass` writes the text of up to six functions for each class and compiles it: half a
millisecond.  A run defines 50 to 100 classes, a third of its time.  Here all share the same functions.
A class of which many objects are made gets the functions of the standard library, which take half as
long, after all.  What is supported behaves the same, and the functions of the module `dataclasses` take
these classes, too.
"""

import dataclasses
from dataclasses import MISSING, Field, FrozenInstanceError, field
from typing import TYPE_CHECKING, Any, TypeVar, cast, dataclass_transform

if TYPE_CHECKING:
    from collections.abc import Callable

    from _typeshed import DataclassInstance


__all__ = ["dataclass", "field", "fields", "replace"]

_Class = TypeVar("_Class", bound=type)
_Object = TypeVar("_Object")
_set = object.__setattr__
_KNOWN_BY = ("__dataclass_fields__", "__dataclass_params__")  # what `dataclasses` looks for in a class
_MANY = 100  # objects, from which on compiled functions pay


@dataclass_transform(field_specifiers=(field,))
def dataclass(cls: _Class | None = None, /, *, frozen: bool = False, eq: bool = True) -> Any:
    """Give a class the methods of a data class; also with brackets, `@dataclass(frozen=True)`."""
    if cls is None:
        return lambda cls: _define(cls, frozen, eq)
    return _define(cls, frozen, eq)


def fields(of: object) -> tuple[Field[Any], ...]:
    """Return the fields of a data class, or of an object of one."""
    found = getattr(of, "_quick_fields", None)
    return dataclasses.fields(cast("DataclassInstance", of)) if found is None else tuple(found.values())


def replace(of: _Object, /, **changes: object) -> _Object:
    """Return a copy of an object in which some fields have other values."""
    kept = {one.name: getattr(of, one.name) for one in fields(of) if one.init and one.name not in changes}
    return type(of)(**kept, **changes)


def _define(cls: Any, frozen: Any, eq: Any) -> Any:
    found = _fields_with_bases(cls)
    cls._quick_fields, cls._quick_options = found, {"frozen": frozen, "eq": eq}
    methods: dict[str, Any] = {"__init__": _initialiser(cls, found), "__repr__": _representation}
    if eq:
        compared = [one.name for one in found.values() if one.compare]
        methods["__eq__"] = _comparison(compared)
        methods["__hash__"] = _hashing(compared) if frozen else None
    if frozen:
        methods["__setattr__"] = _refusal(cls, found, "assign to", object.__setattr__)
        methods["__delattr__"] = _refusal(cls, found, "delete", object.__delattr__)
    for name, method in methods.items():
        if cls.__dict__.get(name) is None:
            setattr(cls, name, method)
    # Type checkers let only class bodies set it.
    cls.__match_args__ = tuple(one.name for one in found.values() if one.init)  # type: ignore[misc]
    for name in _KNOWN_BY:
        setattr(cls, name, _OfTwin(cls, name))
    return cls


def _fields_with_bases(cls: type) -> dict[str, Any]:
    """Fields by name, those of the bases first."""
    found: dict[Any, Any] = {}
    for base in reversed(cls.__mro__[1:]):
        of_base = base.__dict__
        if "__dataclass_fields__" in of_base and "_quick_fields" not in of_base:
            raise TypeError(f"{cls.__qualname__}: the base {base.__qualname__} is of the standard library")
        found |= of_base.get("_quick_fields", {})
    for name, kind in cls.__annotations__.items():
        found[name] = _field(cls, name, kind)
    return found


def _field(cls: type, name: str, kind: Any) -> Any:
    given = cls.__dict__.get(name, MISSING)
    one = given if isinstance(given, Field) else field(default=given)
    if type(one.default).__hash__ is None:
        raise ValueError(f"{cls.__qualname__}.{name}: a mutable default is shared; use default_factory")
    one.name, one.type = name, kind
    if isinstance(given, Field):
        if one.default is MISSING:
            delattr(cls, name)
        else:
            setattr(cls, name, one.default)
    return one


def _initialiser(cls: type, found: dict[str, Any]) -> "Callable[..., Any]":
    """The function __init__: positions and names, defaults, and what the class does afterwards."""
    names = [one.name for one in found.values() if one.init]
    rest = {one.name: one for one in found.values() if not one.init}
    after, whole, left = hasattr(cls, "__post_init__"), len(names), _MANY

    def __init__(self: Any, *given: Any, **named: Any) -> None:
        nonlocal left
        left -= 1
        if not left:
            _take_compiled(cls)
        for name, value in zip(names, given, strict=False):
            _set(self, name, value)
        if named or rest or len(given) != whole:
            _set_others(self, names[len(given) :], given[whole:], named, found)
        if after:
            self.__post_init__()

    __init__.__qualname__ = f"{cls.__qualname__}.__init__"
    return __init__


def _set_others(
    self: Any, names: list[str], surplus: tuple[Any, ...], named: dict[Any, Any], found: dict[str, Any]
) -> None:
    """Set the fields that were not given by position: those `named`, defaults, those without argument."""
    if surplus:
        raise TypeError(f"{type(self).__qualname__}() takes {len(surplus)} arguments less")
    missing = []
    for name in names:
        value = named.pop(name, MISSING)
        value = _default(found[name]) if value is MISSING else value
        if value is MISSING:
            missing.append(name)
        else:
            _set(self, name, value)
    if missing or named:
        wrong = f"misses {missing}" if missing else f"does not know, or has twice, {list(named)}"
        raise TypeError(f"{type(self).__qualname__}() {wrong}")
    for one in found.values():
        if not one.init and (value := _default(one)) is not MISSING:
            _set(self, one.name, value)


def _default(one: Any) -> Any:
    return one.default if one.default_factory is MISSING else one.default_factory()


def _representation(self: Any) -> str:
    shown = (f"{one.name}={getattr(self, one.name)!r}" for one in self._quick_fields.values() if one.repr)
    return f"{type(self).__qualname__}({', '.join(shown)})"


def _comparison(names: list[str]) -> "Callable[..., Any]":
    def __eq__(self: Any, other: Any) -> Any:
        if type(other) is not type(self):
            return NotImplemented
        return [getattr(self, name) for name in names] == [getattr(other, name) for name in names]

    return __eq__


def _hashing(names: list[str]) -> Any:
    return lambda self: hash(tuple([getattr(self, name) for name in names]))


def _refusal(cls: type, names: dict[str, Any], action: str, perform: Any) -> "Callable[..., Any]":
    """Return what stands for __setattr__ or __delattr__ of a frozen class."""

    def refuse(self: Any, name: str, *value: Any) -> Any:
        if type(self) is cls or name in names:
            raise FrozenInstanceError(f"cannot {action} field {name!r}")
        perform(self, name, *value)

    return refuse


def _twin(cls: Any) -> type:
    """A class of the standard library with the same fields."""
    parts = [(one.name, one.type, one) for one in cls._quick_fields.values()]
    afterwards = {name: getattr(cls, name) for name in ("__post_init__",) if hasattr(cls, name)}
    return dataclasses.make_dataclass(cls.__name__, parts, namespace=afterwards, **cls._quick_options)


def _take_compiled(cls: type) -> None:
    """Give a class the functions that the standard library compiles, where it has no others of its own."""
    twin = _twin(cls)
    for name in ("__init__", "__eq__", "__hash__"):
        if getattr(cls.__dict__.get(name), "__module__", None) == __name__:
            setattr(cls, name, twin.__dict__[name])


class _OfTwin:
    """An attribute by which `dataclasses` recognises its classes: made at its first use."""

    def __init__(self, cls: type, name: str):
        self._cls, self._name = cls, name

    def __get__(self, _: object, owner: type | None = None) -> Any:
        twin = _twin(self._cls)
        for name in _KNOWN_BY:
            setattr(self._cls, name, getattr(twin, name))
        return getattr(twin, self._name)
