"""Models of decks: mechanisms and trees in SI units, with names.  No numba."""
