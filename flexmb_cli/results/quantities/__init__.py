"""Quantities of a result by name, and tables of them."""
