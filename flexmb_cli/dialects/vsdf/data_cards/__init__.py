"""Data cards of VSDF decks: each with all its faults, plain ones of large decks quickly."""
