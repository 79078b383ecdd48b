"""Lines that no card reads: DAFMS passes over them in silence, here each group of them is reported."""

import re

from ...deck.fortran_records import Records
from ...deck.number import shown
from ...errors import Place
from ..elements_block.text import BLOCK, begins_block, is_like_block, mentions_block, stray_lines
from .cards import resembling

_DATA = re.compile(r"[ 0-9.+-]{4}")


class SkippedLines:
    """Gathers consecutive skipped lines and notes them as one fault when the run of them ends.

    `where` says which part of the deck they stand in; `card` is the card read last before them.
    """

    def __init__(self, records: Records, where: str):
        self.records = records
        self.where = where
        self.card = ""
        self._first = 0
        self._text = ""
        self._count = 0

    def add(self, line: str) -> None:
        """Take up one more skipped line; blocks of elements, misspelt or misplaced, are never skipped."""
        if not line.strip() or self._refuse_block(line):
            return
        word = line[:4].ljust(4)
        is_data = _DATA.fullmatch(word) is not None
        # A line next to the run's last one belongs to it, but a near miss gets its own message.
        if self._count and not is_data and resembling(word):
            self.flush()
        if not self._count:
            self._first, self._text = self.records.line, line
        self._count += 1

    def _refuse_block(self, line: str) -> bool:
        """Refuse what opens a block, or belongs into one, where none is read."""
        place = Place(self.records.line, 1, max(1, len(line.strip())))
        if begins_block(line):
            message = f"{BLOCK} stands {self.where}; a block stands among the cards between DFMB and END"
            self.records.report("error", "", message, place, id="DAFMS-190")
            return True
        if is_like_block(line):
            message = f"there is no card {shown(line.strip())}; is {BLOCK} meant?"
            self.records.report("error", "", message, place, id="DAFMS-191")
            return True
        strays = list(stray_lines([(self.records.line, line)])) if mentions_block(line) else []
        for fault in strays:
            self.records.report(fault.severity, "", fault.message, fault.place, id=fault.id)
        return bool(strays)

    def flush(self) -> None:
        """Note the lines gathered so far."""
        if not self._count:
            return
        word = self._text[:4].ljust(4)
        width = max(1, len(self._text[:4].rstrip()))
        self._report(word, Place(self._first, 1, width))
        self._count = 0

    def _report(self, word: str, place: Place) -> None:
        report = self.records.report
        more = f", with {_lines(self._count - 1)} after it" if self._count > 1 else ""
        if _DATA.fullmatch(word):
            preceding = f"after card '{self.card}'" if self.card else self.where
            message = f"{_lines(self._count)} {preceding} skipped: no card reads them"
            report("warning", "", message, place, id="DAFMS-186")
        elif known := resembling(word):
            message = f"unknown card '{word}' skipped{more}; is '{known}' meant?"
            report("warning", "", message, place, id="DAFMS-187")
        else:
            report("note", "", f"unknown card '{word}' skipped{more}", place, id="DAFMS-188")


def _lines(count: int) -> str:
    return "1 line" if count == 1 else f"{count} lines"
