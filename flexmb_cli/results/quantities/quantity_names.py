"""Names of the elements of a result's datasets: words from its paths, names and dimension scales."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import h5py

from ...errors import visible
from ..hdf5.stored_result import (
    Damaged,
    StoredDatasets,
    attribute,
    is_number,
    is_text,
    place_of,
    scale_of,
    texts,
)

TIME = "time"
# Names of a dataset's elements, the shortest first; {0} and {1} are its axes after time, {item} the body of
# the datasets that a body has for itself (/elastic/<body>/...).
FORMS = {
    "body/position": ("body.{0}.{1}", "body.{0}.position.{1}"),
    "body/euler_parameters": ("body.{0}.{1}", "body.{0}.euler_parameters.{1}"),
    "body/euler_parameter_rates": ("body.{0}.d{1}", "body.{0}.euler_parameter_rates.{1}"),
    "body/euler_parameter_accelerations": (
        "body.{0}.dd{1}",
        "body.{0}.euler_parameter_accelerations.{1}",
    ),
    "body/angular_velocity": ("body.{0}.omega.{1}", "body.{0}.angular_velocity.{1}"),
    "body/angular_acceleration": ("body.{0}.alpha.{1}", "body.{0}.angular_acceleration.{1}"),
    "point/position": ("point.{0}.{1}", "point.{0}.position.{1}"),
    "signal/value": ("signal.{0}", "signal.{0}.value"),
    "coordinate/q": ("coordinate.{0}", "coordinate.{0}.q"),
    "elastic/displacement": ("elastic.{item}.{0}.{1}", "elastic.{item}.{0}.displacement.{1}"),
    **{f"{quantity}/{kind}_tensor": (f"{quantity}.{{item}}.{{0}}.{{1}}",)
       for quantity in ("stress", "strain") for kind in ("node", "element")},
    **{f"stress/{kind}_von_mises": ("stress.{item}.{0}.von_mises",) for kind in ("node", "element")},
    **{f"{quantity}/{kind}_principal": (f"{quantity}.{{item}}.{{0}}.principal.{{1}}",)
       for quantity in ("stress", "strain") for kind in ("node", "element")},
    "strain/element_energy": ("strain.{item}.{0}.energy",),
    "stress/max_von_mises": ("stress.{item}.max.von_mises",),
    "stress/max_node": ("stress.{item}.max.node",),
}  # fmt: skip
MOTION = (
    "position", "euler_parameters", "velocity", "euler_parameter_rates", "angular_velocity", "acceleration",
    "euler_parameter_accelerations", "angular_acceleration",
)  # fmt: skip
# Groups with a subgroup for every body that has such datasets; modes stand after the quantity, nodes before.
BY_BODY = ("elastic", "modal", "stress", "strain")
# Things that lines of the block ELEMENTS name; a deck's older cards leave them "spring 1".
OF_LINES = ("element", "contact", "composite", "coupling", "curve", "driver", "general", "load")
LABEL = re.compile(r"[A-Za-z][\w-]*")


Labels = tuple[tuple[str, ...], ...]  # spellings for every position along an axis


@dataclass(frozen=True)
class Slot:
    """One word of a name: for every position along `axis` its spellings, the first being flexmb's own."""

    axis: int | None
    words: tuple[tuple[str, ...], ...]

    @property
    def spellings(self) -> list[str]:
        """Everything that may stand at this place."""
        return [word for words in self.words for word in words]

    def positions(self, pattern: re.Pattern[str]) -> list[int]:
        """Return where along the axis a spelling, folded, matches."""
        return [n for n, words in enumerate(self.words) if any(pattern.match(folded(w)) for w in words)]


@dataclass(frozen=True)
class Family:
    """A dataset along time: the forms of its names, units and meanings by position on its first axis."""

    path: str
    shape: tuple[int, ...]
    forms: tuple[tuple[Slot, ...], ...]
    units: tuple[str, ...]
    long_name: str
    items: tuple[str, ...]

    def name(self, index: tuple[int, ...]) -> str:
        """Name of the element at `index` after time."""
        return ".".join(slot.words[0 if slot.axis is None else index[slot.axis]][0] for slot in self.forms[0])

    def unit(self, index: tuple[int, ...]) -> str:
        """Unit of that element."""
        return self.units[index[0] if len(self.units) > 1 else 0]

    def meaning(self, index: tuple[int, ...]) -> str:
        """Return what it is, in words."""
        return f"{self.items[index[0]]}: {self.long_name}" if self.items else self.long_name


def families(result: h5py.File) -> list[Family]:
    """Every dataset of numbers along time, the time first."""
    time, paths, places = place_of(result[TIME]), [], {}
    for path, item in StoredDatasets(result).items():
        places[place_of(item)] = path
        if path != TIME and _runs_along(time, path, item):
            paths.append(path)
    labels = _Labels(result, places)
    return [_family(result, path, labels) for path in (TIME, *sorted(paths, key=_rank))]


def time_family(result: h5py.File) -> Family:
    """The time alone, without a search of the file."""
    return _family(result, TIME, _Labels(result, {}))


def folded(text: str) -> str:
    """Spelling without capitals and blanks, for comparison."""
    return text.lower().replace(" ", "_")


def _runs_along(time: int, path: str, dataset: h5py.Dataset) -> bool:
    scale = scale_of(dataset, 0) if dataset.ndim else None
    if scale is None or place_of(scale) != time:
        return False
    if is_text(dataset):
        raise Damaged(f"/{visible(path)} has text in place of numbers")
    return is_number(dataset)


def _rank(path: str) -> tuple[str, int, str]:
    """Motion in the order of its derivatives, all else by the alphabet."""
    group, _, last = path.rpartition("/")
    return group, MOTION.index(last) if last in MOTION else len(MOTION), last


def _family(result: h5py.File, path: str, labels: "_Labels") -> Family:
    dataset = result[path]
    group, *between = path.split("/")
    item = labels.body(between[0]) if group in BY_BODY and len(between) > 1 else None
    axes = [labels.axis(dataset, number) for number in range(1, dataset.ndim)]
    known = FORMS.get(f"{group}/{between[-1]}" if item else path, ())
    if not known or len(re.findall(r"\{\d\}", known[0])) != len(axes):
        known = (_form(path, item, dataset),)
    forms = tuple(tuple(_slot(word, axes, item) for word in form.split(".")) for form in known)
    long_name = attribute(dataset, "long_name", path.rpartition("/")[2].replace("_", " "))
    units = labels.units(dataset, group)
    return Family(path, dataset.shape[1:], forms, units, long_name, labels.items(dataset))


def _form(path: str, item: tuple[str, ...] | None, dataset: h5py.Dataset) -> str:
    """Name of a dataset without a form of its own: what is numbered, the quantity, its components."""
    group, *words = path.split("/")
    words = words[1:] if item else words
    axes = [f"{{{number}}}" for number in range(dataset.ndim - 1)]
    numbered = 0 if group == "modal" else _numbered_axes(dataset)
    head = [group, "{item}"] if item else [group]
    return ".".join([*head, *words[:-1], *axes[:numbered], *words[-1:], *axes[numbered:]])


def _numbered_axes(dataset: h5py.Dataset) -> int:
    """Return how many axes after time, from the first, count things: bodies, joints, nodes."""
    scales = [scale_of(dataset, axis) for axis in range(1, dataset.ndim)]
    kinds = [scale is not None and is_number(scale) for scale in scales]
    return kinds.index(False) if False in kinds else len(kinds)


def _slot(word: str, axes: Sequence[Labels], item: tuple[str, ...] | None) -> Slot:
    match = re.fullmatch(r"(\w*)\{(\w+)\}", word)
    if match is None:
        return Slot(None, ((word,),))
    prefix, name = match.groups()
    if name == "item":
        return Slot(None, (item or (),))
    axis = int(name)
    return Slot(axis, tuple(tuple(prefix + label for label in labels) for labels in axes[axis]))


class _Labels:
    """Names of the elements along the axes of a result."""

    def __init__(self, result: h5py.File, paths: dict[int, str]):
        self._result = result
        self._known: dict[str, Labels] = {}
        # By place: h5py would search the file for the path of every scale.
        self._paths = paths

    def axis(self, dataset: h5py.Dataset, number: int) -> Labels:
        """Spellings for every position along an axis."""
        scale = scale_of(dataset, number)
        if scale is None:
            return tuple((str(n),) for n in range(1, dataset.shape[number] + 1))
        path = self._path(scale)
        if path not in self._known:
            self._known[path] = tuple(tuple(map(_word, texts)) for texts in self._spellings(scale, path))
        return self._known[path]

    def _path(self, scale: h5py.Dataset) -> str:
        return self._paths.get(place_of(scale), "")

    def _spellings(self, scale: h5py.Dataset, path: str) -> list[tuple[str, ...]]:
        if not is_number(scale):
            return [(text,) for text in texts(scale)]
        numbers = [_number(value) for value in scale[:]]
        names, kind = self._names(scale), path.rpartition("/")[2]
        if names:
            given = list(zip(numbers, names, strict=True))
            if kind in OF_LINES:
                return [(name, number) if LABEL.fullmatch(name) else (number, name) for number, name in given]
            return _with_angles(given) if path.startswith("coordinate/") else [*given]
        if kind == "node":
            return [(f"node{number}", number, f"node {number}") for number in numbers]
        if kind == "element":
            # The number alone is a node's.
            return [(f"element{number}", f"element {number}") for number in numbers]
        return [(number, f"{kind}{number}", f"{kind} {number}") for number in numbers]

    def _names(self, scale: h5py.Dataset) -> list[str]:
        """Names of what a scale counts: beside it, or in its type's group (/reaction/joint: /joint/name)."""
        group, _, kind = self._path(scale).rpartition("/")
        beside = self._listed(f"{group}/name", len(scale))
        return beside or self._listed(f"{kind}/name", len(scale))

    def _listed(self, path: str, count: int) -> list[str]:
        """The names at `path`, none when there is no such list; Damaged unless there are `count`."""
        if path not in self._result:
            return []
        names = texts(self._result[path])
        if len(names) != count:
            raise Damaged(f"{path} has {len(names)} names for {count} things")
        return names

    def body(self, name: str) -> tuple[str, ...]:
        """Number and name of the body that has a group for itself."""
        bodies = self._result.get("body/name")
        given = [] if bodies is None else texts(bodies)
        return (str(given.index(name) + 1), _word(name)) if name in given else (_word(name),)

    def items(self, dataset: h5py.Dataset) -> tuple[str, ...]:
        """Names of the things that the first axis counts."""
        scale = scale_of(dataset, 1) if dataset.ndim > 1 else None
        return tuple(self._names(scale)) if scale is not None and is_number(scale) else ()

    def units(self, dataset: h5py.Dataset, group: str) -> tuple[str, ...]:
        """Unit of the dataset, or one for every element of its first axis (coordinates: rad or m)."""
        stated = attribute(dataset, "units", "1")
        if " or " not in stated or dataset.ndim < 2 or f"{group}/unit" not in self._result:
            return (stated,)
        each = self._listed(f"{group}/unit", dataset.shape[1])
        choices = stated.split(" or ")
        return tuple(_chosen(unit, choices) for unit in each)


def _chosen(unit: str, choices: list[str]) -> str:
    """Return which unit a coordinate's own one means: itself, its rate, or the effort along it."""
    same = next((choice for choice in choices if choice.split("/")[0] == unit), None)
    # Torques are products.
    return same or next(choice for choice in choices if (" " in choice) == (unit == "rad"))


def _with_angles(given: list[tuple[str, str]]) -> list[tuple[str, ...]]:
    """`theta2` is the rotation of body 2, when its hinge has but one."""
    rotations = [re.fullmatch(r"body (\d+) rotation \d", name) for _, name in given]
    bodies = [match[1] if match else None for match in rotations]
    return [
        (*words, f"theta{body}") if body and bodies.count(body) == 1 else words
        for words, body in zip(given, bodies, strict=True)
    ]


def _number(value: float) -> str:
    """The number with all its digits: six made the nodes 1000001 and 1000002 one."""
    return str(int(value)) if float(value).is_integer() else repr(float(value))


def _word(text: str) -> str:
    """A point inside a name would part it."""
    return text.replace(".", "_")
