"""Lines of the block ELEMENTS as `flexmb new` asks for them: how many there are, then each as a whole."""

from collections.abc import Iterator, Sequence

from ...deck.lines import as_lines
from ...deck.questions import INTEGER, TEXT, Cell, Entry
from ...deck.record import Record
from ...errors import Fault
from .reader import BlockReader
from .text import BLOCK, uncommented

COUNT = Cell(BLOCK, "number of lines of functions and elements", letter=INTEGER, default="0")
LINES = "element_line"
_LINE = Cell("text", "WORD name key=value ..., such as SPRING s1 at=1.angle stiffness=10", letter=TEXT)


def line_entries(count: int) -> Iterator[Entry]:
    """Yield the questions for so many lines."""
    return (Entry(LINES, k, f"line {k} of {BLOCK}", (_LINE,)) for k in range(1, count + 1))


def faults_of_line(records: Sequence[Record]) -> list[Fault]:
    """Faults of the last of `records`, a line, behind the lines before it."""
    last = records[-1]
    texts = [f" {record['text']}" for record in records if record.section == LINES]
    reader = BlockReader(as_lines([BLOCK, *texts]), uncommented)
    reader.read(1)
    place, line = last.at("text").place, 1 + len(texts)
    return [
        Fault(fault.severity, fault.message, place, last.subject, id=fault.id)
        for fault in reader.faults
        if fault.place and fault.place.line == line
    ]


def block_lines(records: Sequence[Record]) -> list[tuple[str, str]]:
    """Return the block as pairs (line, prefix of its record), nothing without any."""
    found = [(f"  {record['text']}", record.prefix) for record in records if record.section == LINES]
    return [(BLOCK, ""), *found] if found else []
