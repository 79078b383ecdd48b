"""Tolerances of results in a TOML file: for all files, for files by pattern, for types and for quantities.

rtol = 1e-9                                # of every file
[kinds]
acceleration = { atol = 1e-6 }             # a type of column; a number alone is its atol
[quantities]
"body.3.velocity.*" = { atol = 1e-6 }      # a single quantity
[files."OUT4-BAR*"]                        # what only these files have, in the same form
last_digit = 1
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from typing import Any

from ...deck.text import read_text
from ...deck.toml_table import TomlError, toml_table
from ...errors import DeckError
from .tolerances import KINDS, Tolerance, ToleranceError, Tolerances

FIGURES = ("atol", "rtol", "last_digit")
TABLES = ("types", "quantities")
FORMER_NAME = "kinds"  # of the table of types


@dataclass
class FileTolerances:
    """The tolerances of every file; `files` are those of patterns of names, a later one over an earlier."""

    path: str = ""
    general: Tolerances = field(default_factory=Tolerances)
    files: dict[str, Tolerances] = field(default_factory=dict)
    used: set[str] = field(default_factory=set)

    def of_file(self, name: str) -> Tolerances:
        """Return what holds for the file `name`: a path relative to the folder, with points of `/`."""
        result = self.general
        for pattern, special in self.files.items():
            if fnmatchcase(name, pattern) or fnmatchcase(name.rpartition("/")[2], pattern):
                self.used.add(pattern)
                result = _overruled(result, special)
        return result

    def refuse_unused(self) -> None:
        """Raise `ToleranceError` for patterns that fitted no file and no quantity: they would do nothing."""
        patterns = [("files", pattern) for pattern in self.files if pattern not in self.used]
        for tolerances in (self.general, *self.files.values()):
            names = [name for name in tolerances.quantities if name not in self.general.used]
            patterns += [("quantities", name) for name in names]
        if patterns:
            reported = ", ".join(f'{table} "{pattern}"' for table, pattern in patterns)
            raise ToleranceError(
                f"{self.path}: nothing that was compared has these names: {reported}", id="DIFF-020"
            )


def read_tolerances(path: str, general: Tolerances) -> FileTolerances:
    """Return the tolerances of the file at `path`; what `general` gives counts more than its first lines.

    Raises `ToleranceError` for a file that cannot be read, and for words that mean nothing.
    """
    content = _content(path)
    files = content.pop("files", {})
    if not (isinstance(files, dict) and all(isinstance(table, dict) for table in files.values())):
        raise ToleranceError(
            f'{path}: files: write a table of tolerances for each, [files."PATTERN"]', id="DIFF-023"
        )
    first = _overruled(_tolerances(path, "", content), general)
    shared = {name: _tolerances(path, f'files."{name}".', table) for name, table in files.items()}
    return FileTolerances(path, first, {name: replace(x, used=first.used) for name, x in shared.items()})


def _content(path: str) -> dict[str, Any]:
    """Return the table of the file at `path`, which is untrusted."""
    try:
        source = read_text(path, "file of tolerances")
        if source.warnings:
            raise TomlError("it is not UTF-8", source.warnings[0].place)
        return toml_table(source)
    except DeckError as failure:
        reported = failure.faults[0].message
        raise ToleranceError(f"--tolerances: {path}: {reported}", id="DIFF-021") from failure
    except TomlError as error:
        where = f" (line {error.place.line}, column {error.place.column})" if error.place else ""
        raise ToleranceError(
            f"--tolerances: {path} is not a TOML file: {error}{where}", id="DIFF-022"
        ) from error


def _overruled(general: Tolerances, special: Tolerances) -> Tolerances:
    """Return `general` with all that `special` gives in its place."""
    return replace(
        general,
        atol=general.atol if special.atol is None else special.atol,
        rtol=general.rtol if special.rtol is None else special.rtol,
        last_digit=special.last_digit or general.last_digit,
        kinds=general.kinds | special.kinds,
        quantities=general.quantities | special.quantities,
    )


def _tolerances(path: str, where: str, table: Mapping[Any, Any]) -> Tolerances:
    if FORMER_NAME in table and "types" not in table:
        table = {"types" if name == FORMER_NAME else name: value for name, value in table.items()}
    unknown = [name for name in table if name not in (*FIGURES, *TABLES)]
    if unknown:
        known = ", ".join((*FIGURES, *TABLES, *([] if where else ["files"])))
        raise ToleranceError(
            f"{path}: {where}{unknown[0]}: there is no such setting; these are: {known}", id="DIFF-024"
        )
    for name in TABLES:
        if not isinstance(table.get(name, {}), dict):
            raise ToleranceError(
                f"{path}: {where}{name}: write a table, a tolerance for every name", id="DIFF-025"
            )
    figures = {name: _figure(path, where, name, table[name]) for name in FIGURES if name in table}
    kinds, quantities = (
        {key: _tolerance(path, f"{where}{name}.{key}", value) for key, value in table.get(name, {}).items()}
        for name in TABLES
    )
    for kind in kinds:
        if kind not in KINDS:
            known = ", ".join(KINDS)
            raise ToleranceError(
                f"{path}: {where}types.{kind}: there is no such type; these are: {known}", id="DIFF-026"
            )
    return Tolerances(**figures, kinds=kinds, quantities=quantities)


def _tolerance(path: str, where: str, value: dict[str, float] | float) -> Tolerance:
    """A number is an absolute tolerance."""
    table = value if isinstance(value, dict) else {"atol": value}
    for name in table:
        if name not in FIGURES:
            raise ToleranceError(f"{path}: {where}.{name}: write atol, rtol or last_digit", id="DIFF-027")
    return Tolerance(**{name: _figure(path, f"{where}.", name, figure) for name, figure in table.items()})


def _figure(path: str, where: str, name: str, value: float) -> Any:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not number or not value >= 0 or (name == "last_digit" and not isinstance(value, int)):
        what = "a whole number" if name == "last_digit" else "a number"
        raise ToleranceError(f"{path}: {where}{name} = {value!r}: write {what} not below zero", id="DIFF-028")
    return value
