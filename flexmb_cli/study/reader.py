"""Study files (TOML): which numbers of a deck vary, and what is kept of every case.

A study is data: names are looked up and numbers taken, nothing is evaluated.
"""

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, TypeGuard

from ..deck.expansion.expressions import Formula, WrongFormula, evaluated, formula
from ..deck.record import DeckText
from ..deck.toml_table import DeepNameError, TomlError, toml_table
from ..dialects import DIALECTS
from ..dialects.recognise import AUTO
from ..errors import DeckError, Fault, Place
from .study import GRID, LATIN, MODAL, SAMPLINGS, SERIES, TAKES, TOGETHER, Kept, Study, Varied

TABLES = ("parameters", "results", "targets")
_HEAD = re.compile(r"\s*\[\s*[\"']?([^][\"']*?)[\"']?\s*\]")
_BEFORE_KEY = re.compile(r"\s*\[?\s*")
_BEFORE_KEY_OF_TABLE = re.compile(r"\s*(\w+)\s*\.\s*")
_END = re.compile(r"[]=]")
_MOST_ENDS = 3  # a quoted name may hold an end, or two


def key_places(lines: Iterable[str]) -> dict[tuple[str, str], tuple[int, int]]:
    """Line and column of each name where it first stands as a key.

    By ("", name) anywhere, by (table, name) in one of `TABLES`.  All lines are looked
    through once, however many names there are.
    """
    places: dict[tuple[str, str], tuple[int, int]] = {}
    table = ""
    for number, line in enumerate(lines, 1):
        if line.lstrip().startswith("["):
            head = _HEAD.match(line)
            table = head[1] if head else ""
        for owner, start in _starts(line, table):
            for name, column in _names(line, start):
                places.setdefault((owner, name), (number, column))
    return places


def _starts(line: str, table: str) -> Iterator[tuple[str, int]]:
    """Return where a name may begin, and the table it would be in."""
    before = _BEFORE_KEY.match(line)
    assert before is not None, "it matches nothing, too"
    yield "", before.end()
    if table in TABLES:
        yield table, len(line) - len(line.lstrip())
    dotted = _BEFORE_KEY_OF_TABLE.match(line)
    if dotted and dotted[1] in TABLES:
        yield dotted[1], dotted.end()


def _names(line: str, start: int) -> Iterator[tuple[str, int]]:
    """Return what may be a name there, without quotes, and its column."""
    start += line[start : start + 1] in ('"', "'")
    for _, end in zip(range(_MOST_ENDS), _END.finditer(line, start), strict=False):
        name = line[start : end.start()].rstrip()
        yield name[:-1] if name.endswith(('"', "'")) else name, start + 1


MOST_CASES = 100_000_000
MOST_VALUES = 1_000_000  # of one parameter
KEYS = ("deck", "dialect", "sampling", "together", "count", "seed", "parameters", "results")
_WINDOW = re.compile(r"(.*?)(?:\s+from\s+(\S+))?(?:\s+to\s+(\S+))?\s*")
RANGE_KEYS = ("from", "to", "count", "scale", "value", "tolerance")
SCALES = ("linear", "log")


def read_study(source: DeckText) -> Study:
    """The study of a TOML text; raises DeckError with every fault, each at the line of its name."""
    reader = StudyReader(source, study_table(source))
    study = reader.study()
    if reader.faults:
        raise DeckError(reader.faults)
    return study


def study_table(source: DeckText) -> dict[Any, Any]:
    """Return the table of a study's text; raises DeckError where it is not TOML."""
    try:
        return toml_table(source)
    except DeepNameError as fault:
        message = f"{fault} belongs to no study"
        raise DeckError([Fault("error", message, fault.place, id="STUDY-012")]) from None
    except TomlError as fault:
        _refuse_deck(source)
        message = f"not TOML: {fault}{_bare_text(source, fault.place)}"
        raise DeckError([Fault("error", message, fault.place, id="STUDY-011")]) from None


def _bare_text(source: DeckText, place: Place | None) -> str:
    """Return the remedy where the value at fault is a text without quotes, else an empty text."""
    line = source.lines[place.line - 1] if place and place.line <= len(source.lines) else ""
    match = re.fullmatch(r"\s*([^=#]{1,80}?)\s*=\s*([A-Za-z][^\"'\[{#]{0,200}?)\s*(#.*)?", line)
    return f'; texts stand in quotes: {match[1]} = "{match[2]}"' if match else ""


def _refuse_deck(source: DeckText) -> None:
    """A deck given instead of a study is reported as one."""
    from ..dialects.recognise import dialect_named, recognise

    try:
        title = dialect_named(recognise(source.lines)).title
    except DeckError:
        return
    message = f'this is a {title} deck, not a study; flexmb run computes it, a study names it in deck = "…"'
    raise DeckError([Fault("error", message, Place(1, 1), id="STUDY-028")])


class StudyReader:
    """Walks the tables of a study and collects faults."""

    dialects = (AUTO, *reversed(DIALECTS))

    def __init__(self, source: DeckText, table: dict[Any, Any]):
        self.source, self.table = source, table
        self.faults: list[Fault] = []
        self.within = ""  # the table whose entries are being read

    def study(self) -> Study:
        """Return the study; faults are collected."""
        self._refuse_unknown(self.table, KEYS, "study")
        sampling = self._choice("sampling", SAMPLINGS, GRID)
        sampled = sampling == LATIN
        parameters = [self._varied(name, given, sampled) for name, given in self._entries("parameters")]
        known = [item for item in parameters if item]
        self._check_formulas(known)
        results = [self._kept(*item) for item in self._entries("results")]
        self.within = ""
        count = self._sample_size() if sampled else 0
        if not sampled and "count" in self.table:
            self._fault(
                "count", f"belongs to sampling = {LATIN!r}; others take all values given", id="STUDY-033"
            )
        study = Study(
            self._text("deck"),
            self._choice("dialect", self.dialects, AUTO),
            sampling,
            tuple(known),
            _with_times(tuple(item for item in results if item)),
            count or 0,
            self._whole("seed", 0, 2**32 - 1, 0),
            self._groups(sampling, {item.name for item in known}),
        )
        if not self.faults:
            self._check_size(study)
        return study

    def _sample_size(self) -> Any:
        if "count" in self.table:
            return self._whole("count", 1, MOST_CASES)
        return self._fault(
            "sampling", f"a {LATIN} needs `count`, the number of its cases: count = 100", id="STUDY-034"
        )

    def _check_size(self, study: Study) -> None:
        axes = ([study.parameters[k] for k in axis] for axis in study.axes)
        uneven = [items for items in axes if len({len(item.values) for item in items}) > 1]
        if uneven:
            counts = ", ".join(f"{item.name} has {len(item.values)}" for item in uneven[0])
            which = f"with sampling = {TOGETHER!r} all" if study.sampling == TOGETHER else "a group's"
            self._fault("parameters", f"{which} need as many values: {counts}", id="STUDY-035")
        elif study.cases > MOST_CASES:
            self._fault(
                "parameters", f"make {study.cases} cases; more than {MOST_CASES} are refused", id="STUDY-036"
            )
        elif study.sampling == LATIN and study.count * len(study.parameters) > MOST_CASES:
            self._fault("count", f"times parameters may be {MOST_CASES} at most", id="STUDY-037")

    def _groups(self, sampling: str, known: set[str]) -> tuple[tuple[str, ...], ...]:
        given = self.table.get("together", [])
        groups = given if isinstance(given, list) and all(isinstance(each, list) for each in given) else None
        names = [name for group in groups or () for name in group]
        if groups is None or not all(isinstance(name, str) and name in known for name in names):
            message = 'holds lists of names of [parameters]: together = [["a", "b"]]'
        elif len(set(names)) < len(names):
            message = "names a parameter twice"
        elif groups and sampling != GRID:
            message = f"belongs to sampling = {GRID!r}"
        else:
            return tuple(map(tuple, groups))
        self._fault("together", message, id="STUDY-111")
        return ()

    def _check_formulas(self, parameters: list[Varied]) -> None:
        """Refuse formulas that name what is no parameter, or each other in a circle."""
        names = {item.name for item in parameters}
        formulas = {item.name: item.formula for item in parameters if item.formula}
        for name, one in formulas.items():
            if unknown := [each for each in one.names if each not in names]:
                self._fault(name, f"names {unknown[0]}, which is not in [parameters]", id="STUDY-112")
        if self.faults:
            return
        chosen = {item.name: float(item.values[0]) for item in parameters if item.values}
        for name, value in evaluated(formulas, chosen):
            if isinstance(value, str) and value.startswith("is defined"):
                self._fault(name, f"its formula {value}", id="STUDY-113")
                return

    def _formula(self, name: str, text: str) -> Formula | None:
        """Return the formula in a text of the entry `name`."""
        try:
            return formula(text)
        except WrongFormula as fault:
            self._fault(name, f"{text!r} is not a formula: {fault}", id="STUDY-114")
            return None

    def _entries(self, key: str) -> list[Any]:
        """Names and contents of a table that must not be empty."""
        table = self.table.get(key)
        if not isinstance(table, dict) or not table:
            example = '"driver.1.B" = [1.0, 2.0]' if key == "parameters" else 'top = "max body.3.z"'
            self._fault(
                key,
                f"the table [{key}] is missing or empty; it has entries such as {example}",
                id="STUDY-038",
            )
            return []
        self.within = key
        return list(table.items())

    def _varied(
        self, name: str, given: Mapping[Any, Any] | float | Sequence[Any] | str, sampled: bool
    ) -> Varied | None:
        if isinstance(given, dict):
            return self._range(name, given, sampled)
        if isinstance(given, str):
            parsed = self._formula(name, given)
            return Varied(name, place=self._place(name), formula=parsed) if parsed else None
        if is_number(given):
            return Varied(name, (given,), place=self._place(name))
        if sampled:
            self._fault(
                name, "a sample needs a range { from = 1, to = 2 }, a number or a formula", id="STUDY-039"
            )
            return None
        if not isinstance(given, list) or not given:
            self._fault(
                name,
                "needs a list of numbers or a range { from = 1, to = 2, count = 5 }, a number or a "
                "formula in quotes",
                id="STUDY-040",
            )
            return None
        if not all(map(is_number, given)):
            self._fault(name, "a list holds finite numbers only", id="STUDY-041")
            return None
        return Varied(name, tuple(given), place=self._place(name))

    def _range(self, name: str, given: dict[Any, Any], sampled: bool) -> Varied | None:
        if name_in_full := _dotted(name, given):
            message = f'a name with points stands in quotes: "{name_in_full}" = …'
            self._fault(name, message, self._place(name_in_full), id="STUDY-042")
            return None
        self._refuse_unknown(given, RANGE_KEYS, name)
        if "tolerance" in given or "value" in given:
            return self._toleranced(name, given, sampled)
        start, end, scale = given.get("from"), given.get("to"), given.get("scale", SCALES[0])
        if not is_number(start) or not is_number(end):
            self._fault(name, "a range needs finite numbers `from` and `to`", id="STUDY-043")
            return None
        if scale not in SCALES:
            self._fault(name, f"scale is one of {', '.join(SCALES)}", id="STUDY-044")
            return None
        if scale == "log" and not (start > 0 and end > 0):
            self._fault(name, "a logarithmic range needs positive ends", id="STUDY-045")
            return None
        if sampled:
            if "count" in given:
                self._fault(name, "a sample takes its count from the study's `count`", id="STUDY-046")
                return None
            return Varied(name, (float(start), float(end)), scale == "log", self._place(name))
        count = given.get("count")
        if type(count) is not int or not 2 <= count <= MOST_VALUES:
            self._fault(name, f"a range needs a count from 2 to {MOST_VALUES}", id="STUDY-047")
            return None
        values = _spaced(start, end, count, scale == "log")
        return Varied(name, values, place=self._place(name))

    def _toleranced(self, name: str, given: dict[Any, Any], sampled: bool) -> Varied | None:
        """Return a number that lies anywhere within a tolerance of its value."""
        value, tolerance = given.get("value"), given.get("tolerance")
        if not sampled or len(given) > 2 or not (is_number(value) and is_number(tolerance) and tolerance > 0):
            form = f"{{ value = 0.25, tolerance = 0.001 }}, in a study with sampling = {LATIN!r}"
            self._fault(name, f"a number with a tolerance is written {form}", id="STUDY-140")
            return None
        ends = float(value - tolerance), float(value + tolerance)
        return Varied(name, ends, place=self._place(name), tolerance=float(tolerance))

    def _kept(self, name: str, given: str) -> Kept | None:
        take, _, quantity = given.strip().partition(" ") if isinstance(given, str) else ("", "", "")
        if take not in TAKES or not quantity.strip():
            forms = ", ".join(TAKES)
            self._fault(name, f'a result is written "TAKE QUANTITY" with TAKE one of {forms}', id="STUDY-048")
            return None
        if not _names_a_column(name):
            form = "letters, digits, marks and blanks, but no slash and no blank at its ends"
            self._fault(name, f"a name of a result has {form}", id="STUDY-049")
            return None
        return self._within(name, quantity.strip(), take)

    def _within(self, name: str, text: str, take: str) -> Kept | None:
        """Return a result with the time in which it is taken."""
        window = _WINDOW.fullmatch(text)
        assert window is not None, "all of it may be left out"
        try:
            start, end = float(window[2] or -math.inf), float(window[3] or math.inf)
        except ValueError:
            start, end = 1.0, 0.0
        if not start < end or ((window[2] or window[3]) and take in (SERIES, *MODAL)):
            message = (
                'write the time in which a number is taken as "max body.3.z from 0.5 to 2"; a series has none'
            )
            self._fault(name, message, id="STUDY-115")
            return None
        return Kept(name, window[1], take, self._place(name), start, end)

    def _text(self, key: str) -> str:
        given = self.table.get(key)
        if isinstance(given, str) and given.strip():
            return given
        self._fault(key, 'names the deck: deck = "IN-RSSR.dat"', id="STUDY-050")
        return ""

    def _choice(self, key: str, choices: tuple[str, ...], default: str) -> str:
        given = self.table.get(key, default)
        if given not in choices:
            self._fault(key, f"is one of {', '.join(choices)}", id="STUDY-051")
            return default
        return str(given)

    def _whole(self, key: str, low: int, high: int, default: int | None = None) -> Any:
        given = self.table.get(key, default)
        if type(given) is not int or not low <= given <= high:
            return self._fault(key, f"is an integer from {low} to {high}", id="STUDY-052")
        return given

    def _refuse_unknown(self, table: dict[Any, Any], known: tuple[str, ...], owner: str) -> None:
        for key in table:
            if key not in known:
                self._fault(key, f"unknown in {owner}; known are {', '.join(known)}", id="STUDY-053")

    def _fault(self, name: str, message: str, place: Place | None = None, *, id: str) -> Any:
        place = place or self._place(name)
        self.faults.append(Fault("error", message, place, name, id=id))

    def _place(self, name: str) -> Place | None:
        """Return where the name stands as a key, at best of the table being read."""
        line_and_column = self._places.get((self.within, name)) or self._places.get(("", name))
        return Place(*line_and_column, len(name)) if line_and_column else None

    @cached_property
    def _places(self) -> dict[tuple[str, str], tuple[int, int]]:
        return key_places(self.source.lines)


def _with_times(results: tuple[Kept, ...]) -> tuple[Kept, ...]:
    """The results, with the times of their series: a case may have others than the next."""
    if all(item.take != SERIES for item in results) or any(item.name == "time" for item in results):
        return results
    return (*results, Kept("time", "time", SERIES))


def _names_a_column(name: str) -> bool:
    """HDF5 takes "a/b" for b in a group a, "." for the group itself, and ends a name at a NUL.

    netCDF has no names with a blank at an end; `ncdump` refuses a file with one that begins so.
    """
    bare = bool(name) and name == name.strip()
    return bare and name.isprintable() and "/" not in name and name not in (".", "..")


def _dotted(name: str, given: object) -> str:
    """The name that TOML took apart at its points, "" where the table is a range."""
    if not isinstance(given, dict) or set(given) & set(RANGE_KEYS) or len(given) != 1:
        return ""
    (key, inner), *_ = given.items()
    full = f"{name}.{key}"
    return _dotted(full, inner) or full


def is_number(value: object) -> TypeGuard[float]:
    """Return whether a value of TOML is a finite number."""
    return (type(value) is int and abs(value) < 10**300) or (type(value) is float and math.isfinite(value))


def _spaced(start: float, end: float, count: int, logarithmic: bool) -> tuple[float, ...]:
    """Evenly spaced values, the ends exact."""
    parts = [k / (count - 1) for k in range(1, count - 1)]
    if logarithmic:
        between = [math.exp((1 - x) * math.log(start) + x * math.log(end)) for x in parts]
    else:
        between = [(1 - x) * start + x * end for x in parts]
    return (float(start), *between, float(end))
