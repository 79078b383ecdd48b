"""flexmb: kinematics and dynamics of rigid and flexible multibody systems from legacy decks.

The Python interface is imported at first use: `read_deck`, `check`, `solve`, `sweep`, the types of their
arguments and results, and the exceptions that they raise.
"""

from typing import TYPE_CHECKING

from .version import __version__ as __version__

if TYPE_CHECKING:
    from .interface import (
        AnalysisError,
        CheckReport,
        DeckError,
        FlexmbError,
        ModelError,
        OpenDeck,
        Result,
        RunOptions,
        check,
        read_deck,
        solve,
        sweep,
    )

__all__ = [
    "AnalysisError",
    "CheckReport",
    "DeckError",
    "FlexmbError",
    "ModelError",
    "OpenDeck",
    "Result",
    "RunOptions",
    "__version__",
    "check",
    "read_deck",
    "solve",
    "sweep",
]


def __dir__() -> list[str]:
    """Return all names of the interface, imported or not, for completion in editors."""
    return sorted({*globals(), *__all__})


def __getattr__(name: str) -> object:
    """Import the interface when a name of it is used: commands start without numpy."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import interface

    return getattr(interface, name)
