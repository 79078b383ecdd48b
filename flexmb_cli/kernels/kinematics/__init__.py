"""Constraint equations of YOUNG mechanisms, Newton's method and continuation."""
