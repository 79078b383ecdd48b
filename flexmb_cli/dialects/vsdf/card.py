"""Card of a VSDF deck: a keyword, and the fields of its data cards."""

from dataclasses import dataclass

from ...fe.formats.formats import MATRIX_FORMATS

# A field's letter gives its width: I an integer, F a real, A a word, T text to the end of the line.
WIDTHS = {"I": 5, "F": 10, "A": 4, "T": 0}


@dataclass(frozen=True)
class Column:
    """One field of a card: its key, meaning, SI unit, letter, and the blank columns before it.

    `words`: what a word may be; `default`: the value of an empty field, None when it must be filled;
    `names`: whether the number may be the name of a function.
    """

    key: str
    meaning: str
    unit: str = ""
    letter: str = "F"
    skip: int = 0
    words: tuple[str, ...] = ()
    default: float | int | str | None = 0
    names: bool = False


@dataclass(frozen=True)
class Card:
    """A keyword and its data cards.

    `counted`: "own" when the first field numbers the records 1, 2, ...; "body" when there is one record a
    body; "list" when records are numbered as they come; "single" when there is one in the deck.
    `more`: the column that repeats to the end of the card; `second`: the fields of a second card.
    `bodies`: the type of bodies that it is for, RIGD or FLEX, those of the other type refuse it; "": both.
    """

    word: str
    section: str
    subject: str
    counted: str
    columns: tuple[Column, ...]
    more: Column | None = None
    second: tuple[Column, ...] = ()
    bodies: str = ""

    @property
    def least_body(self) -> int:
        """Return the least number that its field "body" may have: 0, the ground, where it may be empty."""
        (body,) = (column for column in self.columns if column.key == "body")
        return 1 if body.default is None else 0


def card(
    head: str,
    subject: str,
    *columns: Column,
    more: Column | None = None,
    second: tuple[Column, ...] = (),
    bodies: str = "",
) -> Card:
    """Return a card; `head`: its word, its section and how its records are counted."""
    word, section, counted = head.split()
    return Card(word, section, subject, counted, columns, more, second, bodies)


def whole_column(key: str, meaning: str, default: int | None = 0) -> Column:
    """A field of an integer."""
    return Column(key, meaning, letter="I", default=default)


def word_column(key: str, meaning: str, words: tuple[str, ...], default: str | None = None) -> Column:
    """A field of one of some words."""
    return Column(key, meaning, letter="A", skip=1, words=words, default=default)


def vector_columns(key: str, meaning: str, unit: str = "", default: float | None = 0.0) -> tuple[Column, ...]:
    """The fields of three components."""
    return tuple(Column(f"{key}.{axis}", f"{meaning}, {axis}", unit, default=default) for axis in "xyz")


BODY = whole_column("body", "number of the body", None)
NODE = whole_column("node", "node or node set", None)
MATRIX_FORMS = tuple(MATRIX_FORMATS)


def file_card(word: str, section: str, what: str, forms: tuple[str, ...]) -> Card:
    """A card that names a file of a body."""
    form = word_column("form", "format of the file", forms)
    file = Column("file", f"file of the {what}", letter="T", skip=1, default=None)
    return Card(word, section, f"{what} of body {{}}", "body", (BODY, form, file), bodies="FLEX")


def node_list_card(word: str, section: str, what: str) -> Card:
    """A card of nodes of a body."""
    return Card(word, section, f"{what} {{}}", "list", (BODY,), NODE, bodies="FLEX")
