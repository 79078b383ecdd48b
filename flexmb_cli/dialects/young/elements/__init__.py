"""Cards of functions of time and of elements in YOUNG decks."""
