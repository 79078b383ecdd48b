"""Frequency response of a state space, and its random response to a power spectral density.

G(i w) = C (i w 1 - A)^-1 B + D; the mean square of an output is the integral of |G|^2 S over the frequency
(Newland, Random vibrations, spectral and wavelet analysis).
"""

from dataclasses import dataclass

import numpy as np

from .state_space import StateSpace

POINTS = 400  # of a response, even in the logarithm of the frequency
AROUND = np.linspace(-8.0, 8.0, 161)  # half widths of a resonance at which it is sampled, too


@dataclass(frozen=True)
class Response:
    """Response of an output to an input: `frequency` (k,), Hz, and complex `value` (k,), output by input."""

    input: str
    output: str
    unit: str
    frequency: np.ndarray
    value: np.ndarray

    @property
    def phase(self) -> np.ndarray:
        """Return the phase, degrees, without jumps of a whole turn."""
        return np.degrees(np.unwrap(np.angle(self.value)))

    def random(self, frequency: np.ndarray, density: np.ndarray) -> float:
        """Return the root mean square of the output to an input of this one-sided density, by Hz.

        The density is straight in logarithms between its frequencies, and 0 outside of them.
        """
        inside = (self.frequency >= frequency[0]) & (self.frequency <= frequency[-1])
        f = self.frequency[inside]
        spectrum = np.exp(np.interp(np.log(f), np.log(frequency), np.log(density)))
        from scipy.integrate import trapezoid

        return float(np.sqrt(trapezoid(np.abs(self.value[inside]) ** 2 * spectrum, f)))


def frequency_response(space: StateSpace, pair: tuple[int, int], frequency: np.ndarray) -> np.ndarray:
    """Return G (k,) from input number pair[0] to output number pair[1] at frequencies (k,), Hz."""
    number, output = pair
    b, c, d = space.B[:, number], space.C[output], space.D[output, number]
    eye = np.eye(len(space.A))
    systems = 2j * np.pi * frequency[:, None, None] * eye - space.A
    states = np.linalg.solve(systems, np.broadcast_to(b[:, None], (len(frequency), len(b), 1)))[:, :, 0]
    response: np.ndarray = states @ c + d
    return response


def sampled_frequencies(space: StateSpace, low: float, high: float) -> np.ndarray:
    """Return frequencies from low to high, Hz: even in the logarithm, and close about every resonance."""
    values = np.linalg.eigvals(space.A)
    near = (np.abs(values.imag)[:, None] + AROUND * np.abs(values.real)[:, None]) / (2.0 * np.pi)
    all_of = np.concatenate([np.geomspace(low, high, POINTS), near.ravel()])
    return np.unique(np.clip(all_of, low, high))
