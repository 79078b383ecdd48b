"""A deck's model for another program or dialect: the dialect that has the model, and who writes it."""

from dataclasses import replace
from pathlib import PurePath
from typing import Any
from xml.etree import ElementTree

from ..deck.record import Deck, DeckText
from ..deck.text import read_text
from ..deck.units import UNITS, Units
from ..dialects import DIALECTS
from ..dialects.elements_block.line import has_outputs, lines_of, system_of
from ..dialects.recognise import dialect_named, read_deck
from ..errors import DeckError, Fault, FlexmbError, ModelError, Place, visible
from ..model.exchange.conversion import Start
from ..model.exchange.units import in_units
from ..model.loads import DynamicModel
from ..results.models.exudyn import exudyn_script
from ..results.models.mjcf import mjcf
from ..results.models.mjcf_file import mjcf_model
from ..results.models.urdf import urdf_model
from .model import analysis_of, folder_of, model_of, open_deck
from .outcome import Outcome, Run, RunOptions
from .solution import solution_of

SI = "m"
ROBOTS = {".urdf": "robot", ".xml": "mujoco"}  # roots of the files of other programs that are read
ROWS_FOR_RANK = 3  # of the motion: a start at rest in a singular position must leave it


def converted(
    path: str,
    form: str,
    changes: tuple[str, ...] = (),
    unit: str = SI,
    to_unit: str = SI,
    outcome: Outcome | None = None,
) -> str:
    """Return the model of the deck at `path` as text of a form: "mjcf", "exudyn", or a dialect.

    `unit`, `to_unit`: names of `deck.units.UNITS`, in which the numbers of the deck are, and those
    of the new deck are to be.  `outcome` receives the warnings about the deck.  Raises FlexmbError, with the
    deck's name, for a deck with errors and for what the form cannot hold.
    """
    options = RunOptions(changes=changes)
    try:
        if PurePath(path).suffix.lower() in ROBOTS:
            return _of_robot(path, form, (changes, unit, to_unit), outcome or Outcome(path))
        run = Run(outcome or Outcome(path), options)
        deck = open_deck(path, options, run.outcome)
        # What a file is called may come from anywhere, and must not be more than a word of the new file.
        name = visible(PurePath(deck.source.name).stem)
        if form in DIALECTS:
            _refuse_own(deck, form, (unit, to_unit))
        unit = _units_of(deck, form, unit)
        _refuse_signals(deck)
        if has_outputs(deck):
            message = "lines OUTPUT are left out: copy those that you need, with the numbers of the new deck"
            run.outcome.faults.append(Fault("warning", message, id="RESULT-114"))
        if form in DIALECTS:
            units = UNITS[unit], UNITS[to_unit]
            return _in_other_units(deck, form, units) or _deck_of(deck, run, form, units)[0]
        return _for_program(deck, run, form, name)
    except FlexmbError as failure:
        failure.file = failure.file or path
        raise


def _units_of(deck: Deck, form: str, unit: str) -> str:
    """Return the system of a deck's numbers: that which it says, else `unit`."""
    system = system_of(deck)
    if system not in ("", SI) and form not in DIALECTS:
        message = f"the deck is in the units {system}: convert it to a deck in SI units first"
        raise ModelError([Fault("error", message, id="RUN-150")])
    if system and unit not in (SI, system):
        raise ModelError([Fault("error", f"--unit {unit}: the deck says UNITS {system}", id="RUN-151")])
    return system or unit


def _of_robot(path: str, form: str, options: tuple[Any, ...], outcome: Outcome) -> str:
    """Return the model of a URDF or MJCF file as a deck; raises FlexmbError."""
    changes, unit, to_unit = options
    if form not in DIALECTS or changes or unit != SI:
        message = "a URDF or MJCF file converts to a deck, as it is and in SI units; change the deck"
        raise ModelError([Fault("error", message, id="RUN-152")])
    text = read_text(path, "model").text
    try:
        top = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        line, column = error.position
        reported = str(error).partition(":")[0]
        place = Place(line, column + 1)
        raise ModelError([Fault("error", f"this is not XML: {reported}", place, id="RUN-153")]) from None
    notes: list[Fault] = []
    if top.tag not in ROBOTS.values():
        message = f"the file begins with <{visible(top.tag)}>; expected <robot> or <mujoco>"
        raise ModelError([Fault("error", message, id="RUN-154")])
    try:
        model = (urdf_model if top.tag == "robot" else mjcf_model)(top, notes)
    except ValueError as error:
        raise ModelError([Fault("error", f"an attribute is not a number: {error}", id="RUN-155")]) from None
    outcome.faults += notes
    dialect = dialect_named(form)
    model = in_units(model, UNITS[SI], UNITS[to_unit])
    title = f"converted from {visible(PurePath(path).name)}"
    written: str = dialect.part(dialect.rigid_deck)(model, title, UNITS[to_unit])
    return written


def _refuse_signals(deck: Deck) -> None:
    """Refuse decks with signals, whose gains and measures belong to the units and the start of the deck."""
    lines = [line for line in lines_of(deck) if line.word == "SIGNAL"]
    if lines:
        message = "signals do not convert: they measure from the start of this deck, and in its units"
        raise ModelError(
            [Fault("error", message, line.place, line.subject, id="MODEL-050") for line in lines]
        )


def _refuse_own(deck: Deck, form: str, units: tuple[str, str]) -> None:
    """Refuse a deck of this form already, unless it is to be in other units."""
    free = dialect_named(form).any_units
    if deck.dialect == form and not (free and units[0] != units[1]):
        message = f"the deck is a {dialect_named(form).title} deck already"
        message += "; --unit and --to-unit write it in other units, such as --to-unit mm" * free
        raise ModelError([Fault("error", message, id="RUN-060")])


def _in_other_units(deck: Deck, form: str, units: tuple[Units, Units]) -> str:
    """Return the deck's own text in other units, "" where its model has to be written anew."""
    dialect = dialect_named(form)
    if deck.dialect != form or not dialect.other_units:
        return ""
    return dialect.part(dialect.other_units)(deck, *units, _title(deck)) or ""


def _deck_of(deck: Deck, run: Run, form: str, units: tuple[Units, Units]) -> tuple[str, Any]:
    """The model as a deck of the dialect `form`, and what that dialect makes of it."""
    old, new = dialect_named(deck.dialect), dialect_named(form)
    for dialect, part in ((old, old.rigid_model), (new, new.rigid_deck)):
        if not part:
            message = f"{dialect.title} decks are not converted to other dialects"
            raise ModelError([Fault("error", message, id="RUN-061")])
    rigid = old.part(old.rigid_model)(deck, lambda: model_of(deck, run), lambda model: _start(model, run))
    text: str = new.part(new.rigid_deck)(in_units(rigid, *units), _title(deck), units[1])
    try:
        return text, new.build(read_deck(DeckText("converted", text, ""), form), folder_of(run))[0]
    except DeckError as failure:
        # The writer let it through, and the dialect does not accept it.
        reported = "; ".join(fault.sentence for fault in failure.faults if fault.severity == "error")
        message = f"the deck cannot be a {new.title} deck: {reported}"
        raise ModelError([Fault("error", message, id="RUN-062")]) from failure


def _title(deck: Deck) -> str:
    name = visible(PurePath(deck.source.name).name)
    return f"converted from the {dialect_named(deck.dialect).title} deck {name}"


def _for_program(deck: Deck, run: Run, form: str, name: str) -> str:
    """Return the model as text for another program."""
    way = next(name for name in DIALECTS if form in dialect_named(name).programs)
    if deck.dialect == way:
        return _written(model_of(deck, run), form, name)
    text, model = _deck_of(deck, run, way, (UNITS[SI], UNITS[SI]))
    try:
        return _written(model, form, name, text.splitlines()[-1])  # its rounding
    except ModelError as failure:
        there = f"; this is in the deck that --to {way} writes"
        faults = [replace(fault, message=fault.message + there, place=None) for fault in failure.faults]
        raise ModelError(faults) from failure


def _written(model: Any, form: str, name: str, note: str = "") -> str:
    if form == "mjcf":
        return mjcf(model, name, note)
    dynamic = analysis_of(model) == "dynamic"
    if not dynamic or model.analysis != "forward":
        # Other dialects would hold the same drivers.
        why = "; drivers move an inverse run, and they do not convert" * dynamic
        message = f"--to exudyn takes rigid mechanisms under forces: decks with DYNAMICS forward{why}"
        raise ModelError([Fault("error", message, id="RUN-028")])
    start, *later = motion = _motion_of(model, ROWS_FOR_RANK)
    return exudyn_script(model, start, name, later, _degrees_of_freedom(model, motion))


def _degrees_of_freedom(model: DynamicModel, motion: list[dict[str, Any]]) -> int:
    """Return the fewest that the Jacobian leaves at positions of a motion: singular ones have more."""
    from ..solvers.compilation import interpreting
    from ..solvers.constrained.young_dynamics import ForwardDynamics
    from ..solvers.singular.dynamic_singularities import rank_at
    from .check.check import is_small

    with interpreting(is_small(6 * len(model.mechanism.bodies))):
        analysis = ForwardDynamics(model)
        return analysis.arrays.speeds - max(rank_at(analysis, at["r"], at["p"]) for at in motion)


def start_of(model: DynamicModel, run: Run | None = None) -> dict[str, Any]:
    """Return positions "r", Euler parameters "p", velocities "v", "omega" of the bodies at the first time.

    Of joint and tree coordinates "q" where the model reports them.
    """
    return _motion_of(model, 1, run)[0]


def _motion_of(model: DynamicModel, rows: int, run: Run | None = None) -> list[dict[str, Any]]:
    """Return what `start_of` does, of each of the first rows."""
    first = _first_rows_of(model, rows)
    blocks = list(solution_of(first, run or Run(Outcome(""), RunOptions())).blocks())
    names = {"r": "position", "p": "euler_parameters", "v": "velocity", "omega": "angular_velocity"}
    states = []
    for values in blocks:
        for row in range(len(values["time"])):
            motion = {short: values[f"body/{name}"][row] for short, name in names.items()}
            q = values["coordinate/q"][row] if "coordinate/q" in values else ()
            states.append(motion | {"q": q})
    return states


def _start(model: DynamicModel, run: Run) -> Start:
    return Start(**start_of(model, run))


def _first_rows_of(model: Any, rows: int) -> Any:
    mechanism = getattr(model, "mechanism", None)
    timed = mechanism or model
    time = timed.time
    end = min(time.last, time.start + (rows - 1) * time.step)
    timed = replace(timed, time=replace(time, end=end))
    return replace(model, mechanism=timed) if mechanism else timed
