"""Reader of FMBD.DAT, the deck of DAFMS: counts, the DFMB block, flexible bodies, macro cards.

DAFMS thesis (Zhao, 1992), appendix C, MAIN, QCONTR and DFIN; TSYSIN is in `system_cards.py`.
"""

from collections.abc import Sequence
from contextlib import suppress
from typing import Any

from ...deck.fortran_records import Item, MissingRecord, Records, Unreadable
from ...deck.number_list import LongRecord, NumberList, record_of
from ...deck.record import Deck, DeckText, Number, Record, as_lines
from ...deck.several_models import MOST_MODELS
from ...errors import DeckError, Place
from ..elements_block.text import refuse_after, uncommented
from .cards import CARDS, KNOWN_WORDS, MACROS, SWITCHES
from .skipped_lines import SkippedLines
from .system_cards import Layout, read_system

# More would take more than twelve times the deck's size.
MOST_TREE_BODIES = 5000
MOST_SHORT_NUMBERS = 350_000  # outside long lists


def read_dafms(source: DeckText) -> Deck:
    """The deck of `source`; `DeckError` with every fault found when it cannot be read.

    Unknown cards are skipped, as DAFMS does, and listed as notes among the deck's warnings.
    """
    records = Records(source, KNOWN_WORDS)
    read: list[Record] = _Read(records)
    with suppress(Unreadable, MissingRecord):
        _read_deck(records, read)
    if records.errors:
        raise DeckError(records.faults)
    return Deck("dafms", source, tuple(read), tuple(records.faults))


class _Read(list[Record]):
    """The records of a deck; its reading stops where their numbers take too much memory."""

    def __init__(self, records: Records):
        super().__init__()
        self.records = records
        self.numbers = 0

    def append(self, record: Record) -> None:
        """Add a record."""
        self.numbers += 1 + len(record.head if isinstance(record, LongRecord) else record.numbers)
        if self.numbers > MOST_SHORT_NUMBERS:
            message = (
                f"the deck has more than {MOST_SHORT_NUMBERS} numbers outside lists of one body or table"
            )
            self.records.stop("", message, record.place, id="DAFMS-153")
        super().append(record)


def _read_deck(records: Records, read: list[Record]) -> None:
    numbers = _read_size(records)
    layout = Layout(numbers[0].value, numbers[1].value)
    heading = _find_model(records)
    read.append(Record("counts", 0, "counts", numbers))
    read.append(Record("heading", 0, "heading card", (heading,)))
    _read_control(records, layout, read)
    for body in range(layout.bodies):
        if layout.nodes[body]:
            _read_flexible_body(records, layout, body, read)
    read_system(records, layout, read)
    read.append(_read_macros(records))


def _read_size(records: Records) -> tuple[Number, ...]:
    items = [Item("N", "number of bodies"), Item("NDM", "dimension, 2 or 3")]
    numbers = records.read("2I5", items, "counts")
    bodies, dimension = numbers
    if bodies.value < 1 and not records.errors:
        message = f"N = {bodies.value} bodies, need at least 1"
        records.report("error", "counts", message, bodies.place, id="DAFMS-154")
    if bodies.value > MOST_TREE_BODIES:
        message = f"N = {bodies.value} bodies, at most {MOST_TREE_BODIES} are taken"
        records.report("error", "counts", message, bodies.place, id="DAFMS-155")
    if dimension.value not in (2, 3) and not records.errors:
        message = f"NDM = {dimension.value}, the dimension is 2 or 3"
        records.report("error", "counts", message, dimension.place, id="DAFMS-156")
    _stop_at_errors(records)
    return numbers


def _find_model(records: Records) -> Number:
    """Skip lines up to the DFMB card and return it as the heading."""
    skipped = SkippedLines(records, "before DFMB")
    while not records.exhausted:
        line = records.next_card()
        word = records.word()
        if word == "DFMB":
            skipped.flush()
            text = line[:80]
            return Number("DFMB", 1, "heading card", "", Place(records.line, 1, max(1, len(text))), text)
        if word in MACROS:
            message = f"card '{word}' stands before any model; a model begins with a DFMB card"
            records.stop("", message, id="DAFMS-157")
        skipped.add(line)
    skipped.flush()
    return records.end_of_deck("", "a DFMB card")


def _read_control(records: Records, layout: Layout, read: list[Record]) -> None:
    n = layout.bodies
    translations = [_read_dofs(records, "NT", "translation", k) for k in range(1, n + 1)]
    rotations = [_read_dofs(records, "NR", "rotation", k) for k in range(1, n + 1)]
    nodes = _read_list(records, "NUMNP", "number of nodes, 0: rigid", n)
    dofs = _read_list(records, "NDF", "elastic degrees of freedom of a node", n)
    time = records.read("I5", [Item("IT", "number of integration steps")], "time")
    time += records.read("F10.5", [Item("H", "length of a step", "s")], "time")
    _check_nodes(records, nodes, dofs)
    _stop_at_errors(records)
    layout.translations = [numbers[0].value for numbers in translations]
    layout.rotations = [numbers[0].value for numbers in rotations]
    layout.nodes = [number.value for number in nodes]
    layout.dofs = [number.value for number in dofs]
    for k, numbers in enumerate(zip(translations, rotations, nodes, dofs, strict=True), 1):
        slides, revolutions, count, dof = numbers
        read.append(Record("counts", k, f"body {k}", (*slides, *revolutions, count, dof)))
    read.append(Record("time", 0, "time", time))


def _read_dofs(records: Records, name: str, motion: str, k: int) -> tuple[Number, ...]:
    """One NT or NR record: the count and three flags of the hinge of body k."""
    items = [
        Item("KK", "number of the body"),
        Item(name, f"number of free {motion}s of the hinge"),
        *(Item(f"{name}{axis}", f"1: {motion} free, axis {axis}") for axis in (1, 2, 3)),
    ]
    subject = f"{name} of body {k}"
    before = records.errors
    index, count, *flags = records.read("10I5", items, subject)
    if records.errors == before:
        records.check_index(index, k, subject, "records are stored in the order of the bodies")
        _check_flags(records, name, count, flags, subject)
    return count, *flags


def _check_flags(records: Records, name: str, count: Number, flags: list[Number], subject: str) -> None:
    for number in flags:
        if number.value not in (0, 1):
            message = f"{number.key} is a flag, 0 or 1, read {number.value}"
            records.report("error", subject, message, number.place, id="DAFMS-158")
            return
    free = sum(number.value for number in flags)
    if count.value != free:
        message = f"{name} = {count.value}, but {free} of its three flags are 1: they must agree"
        records.report("error", subject, message, count.place, id="DAFMS-159")


def _read_list(records: Records, name: str, meaning: str, count: int) -> tuple[Number, ...]:
    items = [Item(name, f"{meaning}, body {k}") for k in range(1, count + 1)]
    return records.read("10I5", items, name)


def _check_nodes(records: Records, nodes: tuple[Number, ...], dofs: tuple[Number, ...]) -> None:
    for k, (count, dof) in enumerate(zip(nodes, dofs, strict=True), 1):
        if count.value < 0:
            message = f"NUMNP = {count.value}: a body has 0 nodes (rigid) or more"
            records.report("error", f"body {k}", message, count.place, id="DAFMS-160")
        elif count.value and dof.value not in (1, 2, 3):
            message = (
                f"NDF = {dof.value}: a node has 1 (axis 3), 2 (axes 2, 3) or 3 elastic degrees of freedom"
            )
            records.report("error", f"body {k}", message, dof.place, id="DAFMS-161")


def _stop_at_errors(records: Records) -> None:
    """Raise `Unreadable` after an error: after a wrong count nothing can be read."""
    if records.errors:
        raise Unreadable


def _read_flexible_body(records: Records, layout: Layout, body: int, read: list[Record]) -> None:
    """The block of DFIN: nodes, nodal forces, NEQ, ID, skyline addresses, stiffness, masses."""
    k, nodes, size = body + 1, layout.nodes[body], layout.elastic(body)
    axes = (2, 3) if layout.dimension == 2 else (1, 2, 3)
    _read_nodes(records, k, nodes, axes, ("node", "CO", "position", "m"), read)
    _read_nodes(records, k, nodes, axes, ("nodal_force", "PI", "force, inertial axes", "N"), read)
    subject = f"body {k}"
    numbers = records.read("I5", [Item("NEQ", "number of equations, not used")], f"NEQ of {subject}")
    read.append(Record("equations", k, subject, numbers))
    _read_array(records, "ID", "equation number, not used", "", "10I5", (k, size), read)
    before = records.errors
    jdi = _read_array(records, "JDI", "address of the diagonal", "", "10I5", (k, size), read, "counts.jdi")
    if records.errors > before:
        raise Unreadable
    _check_skyline(records, jdi, k)
    _read_array(records, "BKP", "stiffness", "N/m", "6E13.5", (k, jdi[-1].value), read)
    _read_array(records, "BMI", "nodal mass", "kg", "10F10.5", (k, nodes), read)


def _read_nodes(
    records: Records,
    k: int,
    nodes: int,
    axes: tuple[int, ...],
    words: tuple[str, str, str, str],
    read: list[Record],
) -> None:
    section, letter, meaning, unit = words
    for i in range(1, nodes + 1):
        subject = f"{letter} of node {i} of body {k}"
        items = [Item("II", "number of the node")]
        items += [Item(f"{letter}{axis}", f"{meaning}, axis {axis}", unit) for axis in axes]
        before = records.errors
        index, *numbers = records.read("I5,3F10.5", items, subject)
        if records.errors == before:
            records.check_index(index, i, subject, "records are stored in the order of the nodes")
        read.append(Record(f"{section}.{k}", i, f"node {i} of body {k}", tuple(numbers)))


def _read_array(
    records: Records,
    name: str,
    meaning: str,
    unit: str,
    form: str,
    size: tuple[int, int],
    read: list[Record],
    section: str | None = None,
) -> Any:
    """A list of one body.  The skyline's addresses count as counts: the deck's layout hangs on them."""
    k, count = size
    numbers = records.read_list(
        form, count, lambda i: (f"{name}({i + 1})", meaning, unit), f"{name} of body {k}"
    )
    read.append(record_of(section or name.lower(), k, f"body {k}", (), numbers))
    return numbers


def _check_skyline(records: Records, jdi: Sequence[Number], k: int) -> None:
    """Column J holds 1 to J entries, its diagonal last; a wrong address shifts all that follows."""
    before = 0
    addresses = jdi.values if isinstance(jdi, NumberList) else [number.value for number in jdi]
    for column, address in enumerate(addresses, 1):
        if not 1 <= address - before <= column:
            number = jdi[column - 1]
            message = (
                f"{number.key} = {number.value} is not the address of a diagonal, expected "
                f"{_range(before, column)}: a column holds at most as many entries as its number, "
                "the diagonal last"
            )
            records.stop(f"JDI of body {k}", message, number.place, id="DAFMS-162")
        before = address


def _range(before: int, column: int) -> str:
    return "1" if column == 1 else f"{before + 1} to {before + column}"


def _read_macros(records: Records) -> Record:
    """The cards after END: STAR integrates, STOP ends the deck; what follows STOP is never read."""
    stars = []
    skipped = SkippedLines(records, "after END")
    while not records.exhausted:
        line = records.next_card()
        word = records.word()
        if word == "STOP":
            for fault in refuse_after(as_lines(records.lines), uncommented, records.line, "STOP"):
                records.report(fault.severity, "", fault.message, fault.place, id=fault.id)
            break
        if word == "DFMB":
            message = f"of a file up to {MOST_MODELS} models are solved, of standard input one"
            records.stop("", f"a second DFMB card: {message}; split the deck here", id="DAFMS-163")
        elif word == "STAR":
            stars.append(records.line)
        elif word in CARDS:
            message = f"card '{word}' after END is not read; put it before END"
            records.report("warning", "", message, id="DAFMS-164")
        elif word not in SWITCHES:
            skipped.add(line)
    else:
        records.report("warning", "", "the deck ends without a STOP card", id="DAFMS-165")
    skipped.flush()
    if not stars:
        message = "no STAR card: DAFMS reads this model and integrates nothing"
        records.report("warning", "", message, id="DAFMS-166")
    place = Place(stars[0], 1, 4) if stars else None
    return Record("run", 0, "run", (Number("STAR", len(stars), "number of STAR cards", "", place),))
