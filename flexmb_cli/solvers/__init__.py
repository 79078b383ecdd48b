"""Loops over iterations and time: the only callers of the kernels."""
