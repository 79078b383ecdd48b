"""What a deck means: mechanisms and trees in SI units, with names.  No numba."""
