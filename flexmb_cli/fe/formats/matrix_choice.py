"""The matrix that is meant where a file holds several: Nastran's punch and OP4 files, Abaqus' sections."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from .matrix_file import FEFileFault, MatrixFile

# Names that Nastran gives square matrices end so; the first in a file are meant, of K and M in one set.
SETS = ("AAX", "AA", "XX", "GG")
# Letter: beginning of Nastran's name, beginnings of other names; G: geometric (differential) stiffness.
NAMES = {"M": ("M", ("M",)), "K": ("K", ("K", "STIF")), "G": ("KD", ("K",))}
DAMPING = "K4"  # structural damping


class NamedMatrix(NamedTuple):
    """A matrix of a file, which is read when it is chosen."""

    name: str  # in capitals
    usable: bool  # whether its heading says that it is square and real
    read: Callable[[], MatrixFile]  # raises FEFileFault


def chosen(file: str, matrices: Sequence[NamedMatrix], letter: str, name: str) -> MatrixFile:
    """Return the matrix `name` of the file; of an empty name the only one, or the one `letter` (M K G) means.

    Raises FEFileFault, which names the candidates, where none or several may be meant.
    """
    names = [matrix.name for matrix in matrices]
    likely = [name.upper()] if name else names if len(names) == 1 else _likely(matrices, letter)
    fitting = [matrix for matrix in matrices if matrix.name in likely]
    if len(fitting) != 1:
        which = f"{len(fitting)} may be meant" if fitting else f"no {name or letter} among them is meant"
        which += f" ({', '.join(likely[:20])})" if fitting else ""
        message = f"{file} holds {', '.join(names[:20])}: {which}; name a square real one on a card FEMX"
        raise FEFileFault(message, id="FE-043")
    return fitting[0].read()


def _likely(matrices: Sequence[NamedMatrix], letter: str) -> list[str]:
    usable = list(dict.fromkeys(matrix.name for matrix in matrices if matrix.usable))
    (prefix, beginnings), partner = NAMES[letter], "K" if letter == "M" else "M"
    present = [end for end in SETS if prefix + end in usable]
    paired = [end for end in present if partner + end in usable]
    if present:
        return [prefix + (paired or present)[0]]
    return [name for name in usable if name.startswith(beginnings) and not name.startswith(DAMPING)]
