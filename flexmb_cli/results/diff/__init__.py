"""Comparison of listings, series and HDF5 results."""
