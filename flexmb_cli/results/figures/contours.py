"""Colours of the surfaces of finite-element bodies, their range over all rows, and how bodies are shown.

Stresses and strains are superposed from those of the modes; the report's scene does the same (`scene.js`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import h5py
import numpy as np

from ...deck.units import UNITS, Units, Wishes, converted, declared, with_prefix
from ..hdf5.stored_result import attribute
from ..hdf5.stress import COMPONENTS, MOST_STRESSES, strains, von_mises
from ..quantities.quantities import ResultError
from .element_bodies import ElementBody

# The smallest and the largest value, by CONTOURS.
Ranges = dict[str, tuple[float, float]]
VON_MISES, DEFORMATION, ENERGY = "von Mises stress", "deformation", "strain energy of the element"
ORDER = (1, 2, 3)
STRESSES = (VON_MISES, *(f"principal stress {k}" for k in ORDER), *(f"stress {c}" for c in COMPONENTS))
STRAINS = (*(f"principal strain {k}" for k in ORDER), *(f"strain {c}" for c in COMPONENTS))
CONTOURS = (*STRESSES, *STRAINS, DEFORMATION, ENERGY)
# Begin at 0: they have no sign.
UNSIGNED = (VON_MISES, DEFORMATION, ENERGY)
# Stresses and strains that are smaller than this part of the largest one are round-off and have no colour.
ROUND_OFF_PART = 1e-9


def shown_unit(contour: str, ends: tuple[float, float], look: "BodyLook") -> tuple[str, float]:
    """Return the unit in which one of CONTOURS with these ends is shown, and the factor of its values."""
    stored = declared(_unit_of(contour), look.system)
    unit, factor = converted(stored, look.wishes)
    return with_prefix(unit, max(map(abs, ends)), look.wishes) if unit == stored else (unit, factor)


def _unit_of(contour: str) -> str:
    """Return the SI unit of one of CONTOURS, "" for none."""
    return {DEFORMATION: "m", ENERGY: "J"}.get(contour, "Pa" if contour in STRESSES else "")


def nodal_values(body: ElementBody, amplitude: np.ndarray) -> dict[str, np.ndarray]:
    """Values (n, T) at the nodes of a body by CONTOURS, for `amplitude` (T, N)."""
    moved = body.shape @ amplitude.T
    values = _stresses_and_strains(body, amplitude) if body.stress_shape is not None else {}
    return values | {DEFORMATION: np.sqrt(np.square(moved).sum(axis=1))}


def _stresses_and_strains(body: ElementBody, amplitude: np.ndarray) -> dict[str, np.ndarray]:
    stress = np.moveaxis(body.stress_shape @ amplitude.T, 1, -1)
    principal = principal_values(stress)
    values = {VON_MISES: von_mises(stress)}
    values |= {f"principal stress {k}": principal[..., k - 1] for k in ORDER}
    values |= {f"stress {c}": stress[..., k] for k, c in enumerate(COMPONENTS)}
    if body.material:
        strain = strains(stress, *body.material)
        stretched = strains(np.concatenate([principal, np.zeros_like(principal)], axis=-1), *body.material)
        values |= {f"principal strain {k}": stretched[..., k - 1] for k in ORDER}
        values |= {f"strain {c}": strain[..., k] for k, c in enumerate(COMPONENTS)}
    return values


def principal_values(tensor: np.ndarray) -> np.ndarray:
    """Principal values (..., 3), the largest first, of tensors (..., 6), for colours: to about eight digits.

    By the invariants of the deviator; `principal_stresses` is for numbers.
    """
    mean = tensor[..., :3].mean(axis=-1)
    x, y, z = np.moveaxis(tensor[..., :3] - mean[..., None], -1, 0)
    xy, yz, zx = np.moveaxis(tensor[..., 3:], -1, 0)
    radius = von_mises(tensor) / 1.5
    third = x * y * z + 2 * xy * yz * zx - x * yz**2 - y * zx**2 - z * xy**2
    cosine = 4 * third / np.where(radius > 0, radius, 1.0) ** 3
    angle = np.arccos(np.clip(cosine, -1, 1)) / 3
    first, last = mean + radius * np.cos(angle), mean + radius * np.cos(angle + 2 * np.pi / 3)
    return np.stack([first, 3 * mean - first - last, last], axis=-1)


# What is not finite has no colour.
@np.errstate(all="ignore")
def contour_ranges(bodies: Sequence[ElementBody]) -> Ranges:
    """Return the smallest and largest finite value of each of CONTOURS in all rows of `bodies`.

    Those without sign begin at 0.
    """
    ranges: Ranges = {}
    for name, values in (pair for body in bodies for pair in _all_values(body)):
        finite = np.isfinite(values)
        low, high = ranges.get(name, (np.inf, -np.inf))
        low = min(low, float(np.min(values, where=finite, initial=np.inf)))
        ranges[name] = low, max(high, float(np.max(values, where=finite, initial=-np.inf)))
    usable = {name: ends if ends[0] <= ends[1] else (0.0, 0.0) for name, ends in ranges.items()}
    usable |= {name: (0.0, usable[name][1]) for name in UNSIGNED if name in usable}
    for names in (STRESSES, STRAINS):
        least = ROUND_OFF_PART * max(
            (abs(end) for name in names for end in usable.get(name, ())), default=0.0
        )
        for name in usable.keys() & set(names):
            low, high = (0.0 if abs(end) <= least else end for end in usable[name])
            usable[name] = low, high
    return {name: usable[name] for name in CONTOURS if name in usable}


@np.errstate(all="ignore")
def resting_row(bodies: Sequence[ElementBody]) -> int:
    """Return the row of the largest von Mises stress of `bodies` where the first has none, else the first."""
    stressed = [body for body in bodies if body.stress_shape is not None]
    if not stressed:
        return 0
    largest = np.max([_largest_stress(body) for body in stressed], axis=0)
    return int(np.argmax(largest)) if largest[0] <= ROUND_OFF_PART * largest.max() else 0


def _largest_stress(body: ElementBody) -> np.ndarray:
    """Largest finite von Mises stress (T,) at the nodes."""
    largest = np.zeros(len(body.amplitude))
    rows = _rows_at_a_time(body)
    for first in range(0, len(largest), rows):
        part = slice(first, first + rows)
        values = von_mises(np.moveaxis(body.stress_shape @ body.amplitude[part].T, 1, -1))
        largest[part] = np.max(values, axis=0, where=np.isfinite(values), initial=0.0)
    return largest


def _rows_at_a_time(body: ElementBody) -> int:
    """Return of how many rows the stresses are computed together."""
    return max(1, MOST_STRESSES // max(1, len(COMPONENTS) * len(body.undeformed)))


def _all_values(body: ElementBody) -> Iterator[tuple[str, np.ndarray]]:
    rows = _rows_at_a_time(body)
    for first in range(0, len(body.amplitude), rows):
        yield from nodal_values(body, body.amplitude[first : first + rows]).items()
    if body.of_elements:
        yield ENERGY, body.of_elements["strain_energy"]


OWN_COLOURS = "body"  # each body has its own
COLOURS = (*CONTOURS, OWN_COLOURS)
# A magnified deformation is at most as large as the mechanism: beyond, bodies leave the picture.
MOST_SCALE = 1e12  # where nothing deforms


@dataclass(frozen=True)
class BodyLook:
    """`colours`: one of COLOURS; `scale` magnifies deformations.

    `ends`: the values of the first and of the last colour; None: the smallest and the largest of all rows.
    They are in the units that are wanted, `wishes`, else in those of the result, which `system` has.
    """

    colours: str = VON_MISES
    ends: tuple[float, float] | None = None
    scale: float = 1.0
    wishes: Wishes = field(default_factory=dict)
    system: Units = UNITS["m"]

    def of(self, result: h5py.File) -> "BodyLook":
        """Return the look for a result: its ends in the units of the result."""
        system = UNITS.get(attribute(result, "units"), self.system)
        factor = converted(declared(_unit_of(self.colours), system), self.wishes)[1]
        ends = self.ends and (self.ends[0] / factor, self.ends[1] / factor)
        return replace(self, system=system, ends=ends)


DEFAULT_LOOK = BodyLook()


def largest_scale(ranges: Ranges, size: float) -> float:
    """Return the scale, at least 1, that makes the largest deformation as large as `size`, m."""
    largest = ranges.get(DEFORMATION, (0.0, 0.0))[1]
    scale = min(MOST_SCALE, size / largest) if largest > size / MOST_SCALE else MOST_SCALE
    return float(f"{max(1.0, scale):.2g}")


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
            f"deformations cannot be shown {look.scale:g} times as large; choose a scale from 0 to "
            f"{largest:g}, where the largest is as large as the mechanism"
        )
        raise ResultError(path, message, id="RESULT-030")


def _check_colours(path: str, look: BodyLook, ranges: Ranges) -> None:
    """Bodies of one colour each are no fault where the look is that of the default."""
    known = look.colours in CONTOURS and (look.colours != VON_MISES or look.ends is not None)
    if not known or look.colours in ranges:
        return
    if DEFORMATION not in ranges:
        message = f"there is no body with elements to colour by {look.colours}"
    elif look.colours == ENERGY:
        message = "it holds no energies of elements; a card OUTS with ELEM selects elements"
    else:
        message = f"it holds no {look.colours}; stresses and strains need a card MATL with the material"
    raise ResultError(path, message, id="RESULT-028")
