"""The printed table: time, x and y of the bob, a line each; and a log of the rows."""

import numpy as np

from flexmb_cli.deck.listing import Listing, ListingForm, Section

FORM = ListingForm("table of a pendulum", "the word failed")
HEAD = "t x y of a pendulum\n"


class Table:
    def __init__(self, streams, deck, layout, analysis):
        self.table, self.log = streams

    def begin(self):
        self.table.write(HEAD)

    def rows(self, values):
        for t, place in zip(values["time"], values["point/position"][:, 0], strict=True):
            self.table.write(f"{t:.6f} {place[0]:.6f} {place[1]:.6f}\n")
            self.log.write(f"a row at {t:g} s\n")

    def failed(self):
        self.table.write("failed\n")

    stopped = failed


def parse(name, text):
    if not text.startswith(HEAD):
        return None
    lines = text.splitlines()[1:]
    numbers = np.array([line.split() for line in lines if line != "failed"], float)
    rows = len(numbers)
    section = Section(
        ("x", "y"), ("point_position",) * 2, np.arange(rows), np.ones(rows, int), np.arange(2, rows + 2),
        numbers[:, 1:], np.full(2, 1e-6), "point",
    )  # fmt: skip
    return Listing(name, (), numbers[:, 0], 1e-6, {"bob": section}, lines[-1:] == ["failed"], FORM)
