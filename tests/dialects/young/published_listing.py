"""The OUT listings of Appendix B as text, put together from their cells in the layout of the program.

Liang Yong, YOUNG dissertation (1996), Appendix B; what the files hold: tests/published/young/README.md.
The echo is that of the deck; an unreadable cell shows what flexmb computes.
"""

import csv
import io
from collections import defaultdict
from functools import cache

import numpy as np

from flexmb_cli.deck.table_columns import SECTIONS
from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.young.listing import OutTable
from flexmb_cli.results.hdf5.kinematic import kinematic_values
from tests.solvers.kinematics.solved import PUBLISHED, REPOSITORY, rows_of_deck

HEADINGS = {
    "position": "POSITION",
    "velocity": "VELOCITY",
    "acceleration": "ACCELERATION",
    "point": "POINTS OF INTEREST",
}
WIDTHS = {"position": 10, "velocity": 7, "acceleration": 7, "point": 8}
PRINTED = sorted(path.stem for path in PUBLISHED.glob("IN*.csv"))

Cells = dict[tuple[int, str, int], list[str]]


@cache
def published_cells(deck: str) -> Cells:
    """Spellings of a listing's numbers by report row, section and number of the body or point."""
    cells = {}
    with open(PUBLISHED / f"{deck}.csv", newline="") as file:
        for line in csv.DictReader(file):
            step, section, index = int(line["step"]), line["section"], int(line["index"])
            columns = SECTIONS[section]
            given = [line[f"v{k}"] for k in range(1, len(columns.names) + 1)]
            ours = computed(deck, step, section, index)
            pairs = zip(given, ours, columns.decimals, strict=True)
            cells[step, section, index] = [text or f"{value:.{places}f}" for text, value, places in pairs]
    return cells


def computed(deck: str, step: int, section: str, index: int) -> np.ndarray:
    """The numbers of one line as flexmb has them."""
    rows = rows_of_deck(deck)
    columns = {
        "position": (rows.position, rows.euler_parameters),
        "velocity": (rows.velocity, rows.euler_parameter_rates, rows.angular_velocity),
        "acceleration": (rows.acceleration, rows.euler_parameter_accelerations, rows.angular_acceleration),
        "point": (rows.point_position, rows.point_velocity, rows.point_acceleration),
    }
    return np.concatenate([column[step, index - 1] for column in columns[section]])


@cache
def echo(deck: str) -> str:
    """The listing up to its first block."""
    stream = io.StringIO()
    OutTable((stream,), read_deck(read_text(str(REPOSITORY / f"decks/young/{deck}.dat"))), "historic").begin()
    return stream.getvalue()


def listing_text(deck: str, cells: Cells, more: int = 0, blank: str = "") -> str:
    """The whole listing; fields `more` columns wider than the program's, with `blank` before each of them.

    As the program printed them, full fields run into their left neighbours.
    """
    blocks = defaultdict(lambda: defaultdict(list))
    for (step, section, index), words in cells.items():
        fields = (blank + word.rjust(WIDTHS[section] + more) for word in words)
        blocks[step][section].append(f"{index:3d}{''.join(fields)}")
    time = rows_of_deck(deck).time
    pages = [_block(time[step], blocks[step]) for step in sorted(blocks)]
    return echo(deck) + "".join(pages)


def _block(time, sections):
    text = f"\n-----\nTIME= {time:5.3f}\n-----\n"
    for section in HEADINGS:
        if section in sections:
            title = " ".join(SECTIONS[section].names)
            word = "No" if section == "point" else "BODY"
            text += "\n".join([HEADINGS[section], f"{word}  {title}", *sections[section], "", ""])
    return text + "*****\n"


def our_listing(deck: str) -> str:
    """What `flexmb run` writes."""
    stream = io.StringIO()
    table = OutTable((stream,), read_deck(read_text(str(REPOSITORY / f"decks/young/{deck}.dat"))))
    table.begin()
    table.rows(kinematic_values(rows_of_deck(deck)))
    return stream.getvalue()
