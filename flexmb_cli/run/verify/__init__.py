"""Comparison of two formulations of one deck."""
