"""The HDF5 result: writing and reading it."""
