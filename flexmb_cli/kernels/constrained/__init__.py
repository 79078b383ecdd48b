"""Constrained equations of motion in absolute coordinates."""
