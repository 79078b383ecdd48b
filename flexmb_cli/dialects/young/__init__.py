"""YOUNG decks (1996): spatial mechanisms, kinematics and dynamics."""
