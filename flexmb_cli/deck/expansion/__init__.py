"""Variables, formulas and included files of decks: the text that a dialect reads, and where it comes from."""
