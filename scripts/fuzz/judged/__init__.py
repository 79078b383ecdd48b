"""The judge of solved decks, by their texts and rows: it shares nothing with flexmb's solvers."""
