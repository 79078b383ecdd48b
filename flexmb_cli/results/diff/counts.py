"""Counts in sentences: nouns and verbs that agree with their number."""


def counted(number: int, stem: str, one: str = "", many: str = "s") -> str:
    """Return a number and what is counted: 1 file, 2 files."""
    return f"{number} {stem}{one if number == 1 else many}"


def agreeing(number: int, verb: str) -> str:
    """Return the verb of a number of things: 1 differs, 2 differ."""
    return f"{verb}s" if number == 1 else verb
