"""Description of a dialect for the rest of the program: a record that names the parts in its folder."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from ..deck.record import Deck, DeckText, Record
from ..errors import Fault

if TYPE_CHECKING:  # runs read no listings, and those hold arrays
    from ..deck.listing import Listing


class Dialect(NamedTuple):
    """A dialect.  Parts are "module:name" in its folder and imported when they are used; "": it has none."""

    name: str  # as `--dialect` has it
    package: str  # of its folder
    begins: str  # what its decks begin with, in words
    recogniser: str  # function of a deck's lines: whether they begin like that
    reader: str  # function of a DeckText: the Deck, with every number named; raises DeckError
    builder: str  # function of a Deck and its folder: (model, warnings); raises ModelError
    # Class of the printed tables, made of (streams, deck, layout, analysis): the stream of the OUT table,
    # which may be None, and those of `series`.  It has begin(), rows(values by path), failed() and stopped().
    writer: str = ""
    # Functions of (name, text) of a file: the Listing, or None where it is none.
    listing_readers: tuple[str, ...] = ()
    # The same for files known by a column of numbers alone; they are tried after those of all dialects.
    series_readers: tuple[str, ...] = ()
    listing_signs: str = ""  # "no …": what is missing in a file that none of them recognises
    listing_begins: tuple[str, ...] = ()  # of its tables, in small letters without blanks
    series_row: str = ""  # pattern of each line of `series`
    renamed: tuple[str, str] = ("", "")  # IN<rest> gives OUT<rest>; other names <stem>.OUT
    series: tuple[str, ...] = ()  # endings of further tables
    options: tuple[str, ...] = ()  # options of `run` on which only its numbers depend
    methods: tuple[str, ...] = ()  # integrators that `--method` accepts
    stepping: str = ""  # function of a Deck: whether its analysis takes time steps; all do where it is ""
    # Words of joints and constraints: the names in `model/joints.py`.
    joints: Mapping[str, str] = MappingProxyType({})
    curves: tuple[str, ...] = ()  # datasets that `plot` draws by default, the most important first
    form: str = ""  # class of the dialogue of `flexmb new`
    new_name: str = ""  # of the deck that it writes
    relabel: str = ""  # function of a Record and the key of a number that `--set` has changed: the Record
    # For `convert`, of `model.exchange`: function of a Deck, a function that builds its model, and one that
    # gives the Start of a model: the RigidModel; raises ModelError for what it does not know.
    rigid_model: str = ""
    # And back: function of a RigidModel, a title and its units in words: the text of a deck; raises the same.
    rigid_deck: str = ""
    # Function of a Deck, its Units, others and a title: its text in these, None where the model is written.
    other_units: str = ""
    programs: tuple[str, ...] = ()  # for which `convert` takes models of this dialect, others by way of it
    # Numbers that are a function or a point of the kinematic model as they stand in the deck: the keys of the
    # three components by section, "driver" or "point"; record n is item n of the model.
    as_given: Mapping[str, tuple[str, ...]] = MappingProxyType({})
    any_units: bool = False  # whether its numbers may be in any consistent units, and not in SI only
    by_columns: bool = False  # whether cards are read by columns
    second_model: str = ""  # function as `builder` of another model with the same motion, for `verify`

    @property
    def title(self) -> str:
        """Its name in sentences."""
        return self.name.upper()

    def part(self, reference: str) -> Callable[..., Any]:
        """Return what a reference names."""
        module, _, name = reference.partition(":")
        # A command imports the parts that it uses.
        return getattr(import_module(f"{self.package}.{module}"), name)

    def fits(self, lines: Sequence[str]) -> bool:
        """Return whether a deck of these lines begins like one of this dialect."""
        return bool(self.part(self.recogniser)(lines))

    def read(self, source: DeckText) -> Deck:
        """Return the deck with every number named and placed; raises DeckError."""
        return self.part(self.reader)(source)

    def build(self, deck: Deck, folder: Path) -> tuple[object, list[Fault]]:
        """Return the model, file names being relative to `folder`, and the warnings; raises ModelError."""
        return self.part(self.builder)(deck, folder)

    def takes_steps(self, deck: Deck) -> bool:
        """Return whether the deck's analysis takes time steps, rather than solve each row for itself."""
        return self.part(self.stepping)(deck) if self.stepping else True

    def table(self, streams: tuple[Any, ...], deck: Deck, layout: str, analysis: object) -> object:
        """Return what writes the printed tables of a run to `streams`; None where the dialect has none."""
        return self.part(self.writer)(streams, deck, layout, analysis) if self.writer else None

    def listings(self, name: str, text: str, references: Sequence[str]) -> "Iterator[Listing]":
        """Yield what the readers named by `references` make of a file."""
        outcomes = (self.part(reference)(name, text) for reference in references)
        return (listing for listing in outcomes if listing is not None)

    def relabelled(self, record: Record, key: str) -> Record:
        """Return a record whose number `key` has been changed, with the meanings that the others now have."""
        return self.part(self.relabel)(record, key) if self.relabel else record
