"""Shapes of bodies that `flexmb new young` asks for behind the times of a mechanism without other cards."""

from collections.abc import Iterator, Sequence

from ....deck import number
from ....deck.questions import INTEGER, MOST_ASKED, REAL, Cell, Entry
from ....deck.record import Record
from ..shape_cards import SHAPE_CARDS

GEOM = SHAPE_CARDS[0]
SHAPES_ENTRY = Entry(
    "shapes",
    0,
    "shapes for pictures",
    (Cell("GEOM", "number of shapes, 0: lines between joints", letter=INTEGER, default="0"),),
    optional=True,
)


def shape_entries(values: dict[str, str]) -> Iterator[Entry]:
    """Yield the question for the number of shapes, and those for each of them."""
    yield SHAPES_ENTRY
    for k in range(1, _number_of_shapes(values) + 1):
        yield _shape_entry(k)


def _number_of_shapes(values: dict[str, str]) -> int:
    """Return how many shapes are to be asked for: none before the number is known and sensible."""
    try:
        count = number.integer(values["shapes.GEOM"])[0]
    except (KeyError, number.Misspelt):
        return 0
    return count if count <= MOST_ASKED else 0


def _shape_entry(k: int) -> Entry:
    given = len(GEOM.columns) - GEOM.optional
    cells = (
        Cell(column.key, column.meaning, column.unit, INTEGER if column.is_integer else REAL,
             None if at < given else "0")
        for at, column in enumerate(GEOM.columns)
    )  # fmt: skip
    return Entry(GEOM.section, k, f"shape {k}", tuple(cells))


def shape_lines(records: Sequence[Record]) -> list[tuple[str, str]]:
    """Return the lines of the shapes, with the prefix of each line's record."""
    shapes = [record for record in records if record.section == GEOM.section]
    cards = [
        (" ".join([GEOM.keyword, *(n.text for n in record.numbers)]), record.prefix) for record in shapes
    ]
    return [("GEOMETRY", ""), *cards, ("END", "")] if shapes else []
