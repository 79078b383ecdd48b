"""Deck text → Deck: numbers with their names, meanings and places.  No model, no numba."""
