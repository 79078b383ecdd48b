"""Quantities that decks ask for by lines OUTPUT, computed from the rows of any analysis."""
