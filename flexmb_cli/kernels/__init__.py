"""Numba kernels: arrays in, arrays and status codes out; no names, files, units or printing."""
