"""Solution → files: OUT tables, HDF5, comparisons.  No numba."""
