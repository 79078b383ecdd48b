"""Solutions of every type of model: analyses ready to be solved, in the same form for all."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

from ...errors import Fault
from ..outcome import Run

if TYPE_CHECKING:
    import numpy as np

    from ...solvers.kinematics.variants import Variants


class Analysis(Protocol):
    """Interface of an analysis."""

    def rows(self) -> Iterator[Any]:
        """Yield blocks of report rows."""

    @property
    def checkpoint(self) -> Mapping[str, "np.ndarray"]:
        """Return the state after the last block, as arrays by name."""

    def restore(self, checkpoint: dict[str, "np.ndarray"]) -> object:
        """Continue from a checkpoint."""


class NoCount:
    """Counts nothing."""

    @property
    def warnings(self) -> tuple[Fault, ...]:
        """Return the warnings about the values counted."""
        return ()

    def add(self, values: Mapping[str, "np.ndarray"]) -> None:
        """Count a block of values."""

    def __str__(self) -> str:
        return ""


@dataclass(frozen=True)
class Solution:
    """An analysis ready to be solved.

    `analysis.rows()` yields blocks of report rows, `rows` in all; `values` gives a block as arrays by the
    paths of their datasets, which `layout()` describes.  `count` counts them: `add(values)`, its `warnings`
    about them, and as text the statistics.  `model_warnings()` are those about the model, `warnings` those
    of the analysis so far.  `finer(run)` makes the blocks of values of a second, finer run, or None.
    `identity`: what the numbers depend on besides the deck, in JSON's types.

    If it is `resumable`, the analysis has a `checkpoint` after every block, arrays by name, and
    `analysis.restore(checkpoint)` continues from it.  `variants()`: what solves variants of the model
    together, or None.  `outputs` computes those of the deck anew for a block that is stored: the next block
    continues it.
    """

    analysis: Analysis
    rows: int
    layout: Callable[..., Any]
    values: Callable[[Any], Mapping[str, "np.ndarray"]]
    count: NoCount
    model_warnings: Callable[[], list[Fault]] = list
    warnings: list[Fault] = field(default_factory=list)
    finer: Callable[[Run], Iterator[Mapping[str, "np.ndarray"]] | None] = lambda run: None
    identity: dict[str, Any] = field(default_factory=dict)
    resumable: bool = True
    variants: "Callable[[], Variants | None]" = lambda: None
    outputs: Callable[[Mapping[str, "np.ndarray"]], Mapping[str, "np.ndarray"]] = lambda values: values

    def blocks(self) -> Iterator[Mapping[str, "np.ndarray"]]:
        """Yield the blocks of values; raises as the analysis does."""
        return map(self.values, self.analysis.rows())

    def blocks_counted(self) -> Iterator[Mapping[str, "np.ndarray"]]:
        """Yield the blocks of values and count them."""
        for values in self.blocks():
            self.count.add(values)
            yield values
