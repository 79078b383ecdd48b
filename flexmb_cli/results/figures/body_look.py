"""Look of finite-element bodies: colours, the values between which these go, scale of the deformation."""

from dataclasses import dataclass

from ..quantities.quantities import ResultError
from .contours import CONTOURS, DEFORMATION, ENERGY, VON_MISES, Ranges

OWN_COLOURS = "body"  # each body has its own
COLOURS = (*CONTOURS, OWN_COLOURS)
# A magnified deformation is at most as large as the mechanism: beyond, bodies leave the picture.
MOST_SCALE = 1e12  # where nothing deforms


@dataclass(frozen=True)
class BodyLook:
    """`colours`: one of COLOURS; `scale` magnifies deformations.

    `ends`: the values of the first and of the last colour; None: the smallest and the largest of all rows.
    """

    colours: str = VON_MISES
    ends: tuple[float, float] | None = None
    scale: float = 1.0


DEFAULT_LOOK = BodyLook()


def largest_scale(ranges: Ranges, size: float) -> float:
    """Return the scale, at least 1, that makes the largest deformation as large as `size`, m."""
    largest = ranges.get(DEFORMATION, (0.0, 0.0))[1]
    found = min(MOST_SCALE, size / largest) if largest > size / MOST_SCALE else MOST_SCALE
    return float(f"{max(1.0, found):.2g}")


def shown_colours(look: BodyLook, ranges: Ranges) -> str:
    """Return the colours of a result of `ranges`: without stresses the default is the deformation."""
    if look.colours in ranges or look.colours != VON_MISES:
        return look.colours
    return DEFORMATION if DEFORMATION in ranges else OWN_COLOURS


def check_look(path: str, look: BodyLook, ranges: Ranges, size: float) -> None:
    """Raise `ResultError` where a result of `ranges` and `size`, m, cannot be shown as `look` wants it."""
    _check_colours(path, look, ranges)
    if look.scale != 1 and DEFORMATION not in ranges:
        message = "there is no body with elements whose deformation could be magnified"
        raise ResultError(path, message, id="RESULT-029")
    largest = largest_scale(ranges, size)
    if not 0 <= look.scale <= largest:
        message = (
            f"deformations cannot be shown {look.scale:g} times as large; wanted is a scale from 0 to "
            f"{largest:g}, where the largest is as large as the mechanism"
        )
        raise ResultError(path, message, id="RESULT-030")


def _check_colours(path: str, look: BodyLook, ranges: Ranges) -> None:
    """Bodies of one colour each are no fault where the look is that of the default."""
    wanted = look.colours in CONTOURS and (look.colours != VON_MISES or look.ends is not None)
    if not wanted or look.colours in ranges:
        return
    if DEFORMATION not in ranges:
        message = f"there is no body with elements to colour by {look.colours}"
    elif look.colours == ENERGY:
        message = "it holds no energies of elements; a card OUTS with ELEM selects elements"
    else:
        message = f"it holds no {look.colours}; stresses and strains need a card MATL with the material"
    raise ResultError(path, message, id="RESULT-028")
