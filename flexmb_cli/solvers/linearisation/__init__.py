"""Linearised motion in joint coordinates, equilibria, state space."""
