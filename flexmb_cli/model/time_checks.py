"""Limits of double precision: times, and tolerances of a step; the number of rows to compute."""

LONGEST_TIME, SHORTEST_TIME = (
    1e9,
    1e-12,
)  # s: 30 years, and what is left of a second when its last digits are taken
MOST_ROWS = 10_000_000
FINEST = 1e-14  # relative tolerance of a step; round-off is 2e-16 of every number, and a step adds dozens


def unsteppable(end: float, interval: float) -> str:
    """Return why a motion up to `end`, with rows `interval` apart, cannot be integrated; "" if it can."""
    if end > LONGEST_TIME:
        return (
            f"the last time would be {end:.3g} s; motions are integrated up to {LONGEST_TIME:g} s (30 years)"
        )
    if 0.0 < interval < SHORTEST_TIME:
        return f"the time between rows is {interval:.3g} s; below {SHORTEST_TIME:g} s there is only round-off"
    return ""


def too_fine(rtol: float) -> str:
    """Return why a relative tolerance cannot be kept; "" if it can."""
    if rtol >= FINEST:
        return ""
    return f"a relative tolerance of {rtol:g} is finer than round-off allows; {FINEST:g} is the finest"
