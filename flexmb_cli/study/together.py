"""Cases that differ only in numbers that no model has to be made for: solved by one call of a kernel."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..dialects.dialect import Dialect
from ..results.hdf5.kinematic import kinematic_values
from ..results.hdf5.layout import Values
from ..run.solution import Solution

if TYPE_CHECKING:
    from ..solvers.kinematics.variants import Variants


@dataclass(frozen=True)
class CasesTogether:
    """`places`: section, index of the record and of the component of each parameter of the study."""

    variants: "Variants"
    places: tuple[tuple[str, int, int], ...]

    @classmethod
    def of(cls, names: list[str], dialect: Dialect, solution: Solution) -> "CasesTogether | None":
        """Return how cases of other numbers of these `names` are solved together, or None."""
        variants = solution.variants()
        if variants is None or not variants.at_once:
            return None
        places = [place for name in names if (place := _place(name, dialect))]
        return cls(variants, tuple(places)) if len(places) == len(names) else None

    def solve(self, values: np.ndarray) -> tuple[Values, np.ndarray]:
        """Return the values of the rows of all cases, one behind the other, and which cases count (cases,).

        values (cases, parameters): those of the study.
        """
        numbers = {
            section: np.repeat(given[None], len(values), axis=0)
            for section, given in (("driver", self.variants.functions), ("point", self.variants.points))
        }
        for (section, index, component), column in zip(self.places, values.T, strict=True):
            numbers[section][:, index, component] = column
        rows, plain = self.variants.solve(numbers["driver"], numbers["point"])
        return kinematic_values(rows), plain


def _place(name: str, dialect: Dialect) -> tuple[str, int, int] | None:
    section, _, rest = name.partition(".")
    number, _, key = rest.partition(".")
    keys = dialect.as_given.get(section, ())
    return (section, int(number) - 1, keys.index(key)) if key in keys else None
