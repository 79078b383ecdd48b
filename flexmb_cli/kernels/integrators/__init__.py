"""Integrators: DOP853, SDIRK4, Radau IIA of order 5, generalised-α."""
