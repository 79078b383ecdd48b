"""Functions of time and elements at joints: one meaning of their cards in all dialects."""
