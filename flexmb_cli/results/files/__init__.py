"""File names, atomic replacement, foreign formats."""
