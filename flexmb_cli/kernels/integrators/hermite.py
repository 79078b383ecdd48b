"""Hermite interpolation between the ends of a step: the dense output of the implicit methods."""

from .._jit import kernel


@kernel
def quintic(x: float, a: float, b: float, v: float, w: float, p: float, r: float):
    """Value and derivative at x; a, b, v, w, p, r: values, first and second derivatives at 0 and at 1."""
    rest, slope, bend = b - a - v - 0.5 * p, w - v - p, r - p
    c3 = 10.0 * rest - 4.0 * slope + 0.5 * bend
    c4 = -15.0 * rest + 7.0 * slope - bend
    c5 = 6.0 * rest - 3.0 * slope + 0.5 * bend
    value = a + x * (v + x * (0.5 * p + x * (c3 + x * (c4 + x * c5))))
    return value, v + x * (p + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)))


@kernel
def cubic_slope(x: float, a: float, b: float, da: float, db: float):
    """Derivative of `cubic` at x."""
    change = b - a
    return da + x * (2.0 * (3.0 * change - 2.0 * da - db) + 3.0 * x * (da + db - 2.0 * change))


@kernel
def cubic(x: float, a: float, b: float, da: float, db: float):
    """Value at x; a, b, da, db: values and derivatives at 0 and at 1."""
    change = b - a
    return a + x * (da + x * (3.0 * change - 2.0 * da - db + x * (da + db - 2.0 * change)))
