"""Columns and cards that stand in several tables."""

from ....fe.formats.formats import MATRIX_FORMATS
from ..card import Card, Column, whole_column, word_column

BODY = whole_column("body", "number of the body", None)
NODE = whole_column("node", "node or node set", None)
MATRIX_FORMS = tuple(MATRIX_FORMATS)


def file_card(word: str, section: str, what: str, forms: tuple[str, ...]) -> Card:
    """A card that names a file of a body."""
    columns = (
        BODY,
        word_column("form", "format of the file", forms),
        Column("file", f"file of the {what}", letter="T", skip=1, default=None),
    )
    return Card(word, section, f"{what} of body {{}}", "body", columns, bodies="FLEX")


def node_list_card(word: str, section: str, what: str) -> Card:
    """A card of nodes of a body."""
    return Card(word, section, f"{what} {{}}", "list", (BODY,), NODE, bodies="FLEX")
