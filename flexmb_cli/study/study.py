"""A study: one deck, the numbers of it that vary, how they are combined, and what is kept of every case."""

from dataclasses import dataclass
from math import prod

from ..errors import Place

GRID, TOGETHER, LATIN = "grid", "together", "latin-hypercube"
SAMPLINGS = (GRID, TOGETHER, LATIN)
LAST, FIRST, LARGEST, SMALLEST, MEAN, SERIES = "last", "first", "max", "min", "mean", "series"
TAKES = (LAST, FIRST, LARGEST, SMALLEST, MEAN, SERIES)


@dataclass(frozen=True)
class Varied:
    """A number of the deck by its readable name, and its values; of a sampled one, the ends of its range.

    `logarithmic`: a sample is even in the logarithm of the number.  `place`: in the study's file.
    """

    name: str
    values: tuple[float | int, ...]
    logarithmic: bool = False
    place: Place | None = None


@dataclass(frozen=True)
class Kept:
    """A result of every case: its name in the table, the quantity, and which of its values is taken.

    `place`: in the study's file.
    """

    name: str
    quantity: str
    take: str
    place: Place | None = None


@dataclass(frozen=True)
class Study:
    """`deck`: path beside the study's own; `sampling` one of SAMPLINGS; `count` and `seed` of a sample."""

    deck: str
    dialect: str
    sampling: str
    parameters: tuple[Varied, ...]
    results: tuple[Kept, ...]
    count: int = 0
    seed: int = 0

    @property
    def cases(self) -> int:
        """Return how many variants there are."""
        if self.sampling == LATIN:
            return self.count
        lengths = [len(item.values) for item in self.parameters]
        return prod(lengths) if self.sampling == GRID else lengths[0]

    @property
    def keeps_series(self) -> bool:
        """Return whether any result is kept row by row."""
        return any(item.take == SERIES for item in self.results)

    def row_of(self, case: int) -> list[float | int]:
        """Values of the parameters of a case that needs no sample; in a grid the last one varies fastest."""
        if self.sampling == TOGETHER:
            return [item.values[case] for item in self.parameters]
        row = []
        for item in reversed(self.parameters):
            case, k = divmod(case, len(item.values))
            row.append(item.values[k])
        return row[::-1]
