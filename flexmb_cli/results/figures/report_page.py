"""One self-contained HTML page on a result: status, moving picture, curves, audit, deck and its echo.

The viewer is the package's own (`viewer/`, 35 kB, drawn without WebGL), and curves are SVG: a page needs no
network and no library.  The page's content security policy names the one script by its hash and forbids
everything else, network included; whatever comes from the file is escaped besides.
"""

import base64
import hashlib
import json
import math
from dataclasses import dataclass, replace
from html import escape
from importlib.resources import files
from string import Template
from typing import Any

import h5py
import numpy as np

from ...deck.record import DeckText
from ...deck.units import AS_STORED, Wishes
from ...dialects.recognise import read_deck
from ...dialects.settings import apply_settings
from ...errors import DeckError, lines_visible
from ..hdf5.stored_result import Damaged, attribute, check_shapes, is_number, is_text, settings_of, texts
from ..quantities.quantities import ResultError, names, remarks, resolve, shortfall
from ..texts.echo import echo
from .contours import DEFAULT_LOOK, BodyLook
from .curves import Curve, DefaultCurves, Panel, Source, default_curves, panels, still_energies
from .extremes import extremes
from .look import COLOURS
from .report_scene import report_scene

PIXELS_WIDE, PIXELS_HIGH = 1000, 300
LEFT, RIGHT, TOP, BOTTOM = 90, 34, 14, 44
# Width of a digit in the large letters of a narrow screen, and what parts a number from the frame.
DIGIT, GAP = 23, 14
ENVELOPE_COLUMNS = 450
# More points than this for each column are an envelope.
POINTS_PER_COLUMN = 3
_DASHES = ("", "7 4", "2 3", "9 3 2 3")


def curve_figure(panel: Panel, title: str, number: int) -> str:
    """HTML of a panel: heading, SVG and a legend; `title` says what is drawn."""
    frame = _Frame(panel)
    curves = "".join(_curve(frame, curve, k) for k, curve in enumerate(panel.curves))
    legend = "".join(
        f'<li><svg width="30" height="10"><path d="M0 5H30" {_style(k)}/></svg> {escape(curve.label)}</li>'
        for k, curve in enumerate(panel.curves)
    )
    return (
        f'<figure class="curves" id="curves{number}"><figcaption>{escape(title)}</figcaption>'
        f'<svg viewBox="0 0 {PIXELS_WIDE} {PIXELS_HIGH}" role="img" aria-label="{escape(title)}">'
        f"{frame.drawn(panel.x_label)}{curves}</svg><ul>{legend}</ul></figure>"
    )


def _style(k: int, fill: str = "none") -> str:
    dash = _DASHES[k // len(COLOURS) % len(_DASHES)]
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    return f'fill="{fill}" stroke="{COLOURS[k % len(COLOURS)]}" stroke-width="1.6"{dashed}'


class _Frame:
    """The box of a panel: from values to places in the picture."""

    def __init__(self, panel: Panel):
        xs, ys = ([getattr(curve, key) for curve in panel.curves] for key in "xy")
        self.x = _range(xs, 0.0)
        self.y = _range(ys, 0.05)
        self.left = max(LEFT, DIGIT * max(len(text) for _, text in _ticks(*self.y)) + GAP)
        self.right = PIXELS_WIDE - max(RIGHT, DIGIT / 2 * len(_ticks(*self.x)[-1][1]) + GAP / 2)

    def places(self, x: float | np.ndarray, y: float | np.ndarray) -> np.ndarray:
        """Places (n, 2) of values."""
        across = self.left + (x - self.x[0]) / (self.x[1] - self.x[0]) * (self.right - self.left)
        down = PIXELS_HIGH - BOTTOM - (y - self.y[0]) / (self.y[1] - self.y[0]) * (PIXELS_HIGH - TOP - BOTTOM)
        return np.column_stack([across, down])

    def drawn(self, x_label: str) -> str:
        """Grid, ticks and the name of the x axis."""
        parts = []
        ticks = _ticks(*self.x)
        every = self.shown_when_narrow(ticks)
        for k, (value, text) in enumerate(ticks):
            x, kind = self.places(value, self.y[0])[0, 0], "below" if k % every == 0 else "below between"
            parts.append(f'<path class="grid" d="M{x:.1f} {TOP}V{PIXELS_HIGH - BOTTOM}"/>')
            parts.append(
                f'<text class="{kind}" x="{x:.1f}" y="{PIXELS_HIGH - BOTTOM + 17}"'
                f' text-anchor="middle">{text}</text>'
            )
        for value, text in _ticks(*self.y):
            y = self.places(self.x[0], value)[0, 1]
            parts.append(f'<path class="grid" d="M{self.left} {y:.1f}H{self.right:g}"/>')
            parts.append(
                f'<text class="beside" x="{self.left - 7}" y="{y + 4:.1f}" text-anchor="end">{text}</text>'
            )
        middle = (self.left + self.right) / 2
        parts.append(
            f'<text class="title" x="{middle}" y="{PIXELS_HIGH - 6}"'
            f' text-anchor="middle">{escape(x_label)}</text>'
        )
        return "".join(parts)

    def shown_when_narrow(self, ticks: list[tuple[float, str]]) -> int:
        """Return 1 where all numbers of the x axis have room in large letters, 2 for every other one, 3 …"""
        widest = DIGIT * max(len(text) for _, text in ticks) + GAP
        return max(1, math.ceil(widest * (len(ticks) - 1) / (self.right - self.left)))


def _range(arrays: list[np.ndarray], margin: float) -> tuple[float, float]:
    values = np.concatenate([array[np.isfinite(array)] for array in arrays])
    if not values.size:
        return 0.0, 1.0
    low, high = float(values.min()), float(values.max())
    size = high - low
    if size <= 1e-12 * max(abs(low), abs(high)) or size == 0.0:
        size = abs(high) or 1.0
        margin = 0.5
    return low - margin * size, high + margin * size


def _ticks(low: float, high: float) -> list[tuple[float, str]]:
    """About six round values between the ends, and their texts."""
    raw = (high - low) / 6
    power = 10.0 ** np.floor(np.log10(raw))
    step = power * next(one for one in (1, 2, 5, 10) if one * power >= raw)
    values = np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1) * step
    return [(float(value), _shown(float(value))) for value in values]


def _shown(value: float) -> Any:
    """The number as short as it can be written: 5e6."""
    mantissa, mark, power = f"{value + 0.0:.5g}".partition("e")
    return f"{mantissa}{mark}{int(power) if power else ''}".replace("-", "\N{MINUS SIGN}")


def _curve(frame: _Frame, curve: Curve, k: int) -> str:
    x, y = (np.asarray(values, float) for values in (curve.x, curve.y))
    known = np.isfinite(x) & np.isfinite(y)
    x, y = x[known], y[known]
    if not len(x):
        return ""
    if len(x) > POINTS_PER_COLUMN * ENVELOPE_COLUMNS and (np.diff(x) > 0).all():
        outline = _points(frame.places(*_envelope(x, y)))
        drawn = _style(k, COLOURS[k % len(COLOURS)])
        return f'<path class="envelope" d="M{outline}Z" {drawn} fill-opacity="0.35"/>'
    return f'<path d="M{_points(frame.places(x, y))}" {_style(k)}/>'


def _envelope(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The outline of a curve by its extremes in columns: along the largest values and back."""
    column = np.minimum(((x - x[0]) / (x[-1] - x[0]) * ENVELOPE_COLUMNS).astype(int), ENVELOPE_COLUMNS - 1)
    first = np.flatnonzero(np.diff(column, prepend=-1))
    # A column begins with the last value of the one before, so that the outline has no gaps.
    high, low = np.maximum.reduceat(y, first), np.minimum.reduceat(y, first)
    before = np.concatenate([y[:1], y[first[1:] - 1]])
    high, low = np.maximum(high, before), np.minimum(low, before)
    return np.concatenate([x[first], x[first][::-1]]), np.concatenate([high, low[::-1]])


def _points(places: np.ndarray) -> str:
    return "L".join(f"{x:.1f} {y:.1f}" for x, y in places.tolist())


@dataclass(frozen=True)
class PageWords:
    """Words of a user on a page: its title, a note, and names of the quantities that are drawn."""

    title: str = ""
    note: str = ""
    curves: tuple[str, ...] = ()


NO_WORDS = PageWords()
AUDITED = {"time": "t", "energy/total": "t", "energy/kinetic": "t"}

TITLES = {"kinematic": "Kinematics", "dynamic": "Dynamics", "static": "Equilibrium", "modal": "Modes"}


def report_page(result: h5py.File, look: BodyLook = DEFAULT_LOOK, words: PageWords = NO_WORDS) -> str:
    """The page on `result`, which opens with `look`, with the `words` of its user.

    Raises `ResultError` when the file has no deck."""
    if "deck" not in result:
        raise ResultError(result.filename, "this is not a result of a run: it has no deck", id="RESULT-001")
    scene = report_scene(result, look)
    check_shapes(result, AUDITED, {})
    script = viewer_script()
    return Template(_viewer("page.html")).substitute(
        hashes=script_hash(script),
        title=shown_html(words.title or _title(result)),
        status=_status(result) + _note(words.note),
        motion=_viewer("motion.html") if scene else "<p>There are no rows to draw.</p>",
        curves=_curves_and_extremes(result, look.wishes, words.curves),
        audit=_table(_audit(result)),
        run=_table(_run(result)),
        changes=_changes(result),
        deck=shown_html(_deck(result)),
        echo=_echo(result),
        figures=json_text({"scene": scene}),
        script=script,
    )


def viewer_script() -> str:
    """Return the script of the page."""
    return "".join(_viewer(f"{part}.js") for part in ("raster", "values", "scene", "viewer"))


def _viewer(name: str) -> str:
    return (files(__package__) / "viewer" / name).read_text(encoding="utf-8")


def _title(result: h5py.File) -> str:
    """Return what was computed of which deck: "Kinematics of IN4-BAR"."""
    analysis, deck = attribute(result, "analysis"), attribute(result, "deck_name")
    stem = deck.rpartition(".")[0] or deck
    return f"{TITLES.get(analysis, analysis)} of {stem}"


ECHO = """<details id="echo"><summary>Every number of the deck: line, name, value, unit, meaning</summary>
<p>{}</p>
<pre>{}</pre></details>"""
AS_TYPED = "As the deck's text has them."
AS_CHANGED = "As this run had them; what --set changed has that word in place of its line."


def _note(text: str) -> str:
    """A user's note, a paragraph for each that empty lines part."""
    paragraphs = (part.strip() for part in text.replace("\\n", "\n").split("\n\n"))
    return "".join(f'<p class="note">{shown_html(part)}</p>' for part in paragraphs if part)


def _curves_and_extremes(result: h5py.File, wishes: Wishes, named: tuple[str, ...]) -> str:
    """The curves that are named, else the default ones, and the extremes of what they show."""
    if named:
        chosen = DefaultCurves(resolve(result, named, result.filename, "--curves "), [])
    else:
        chosen = default_curves(result)
    left_out = "" if named else _left_out(result)
    return curves_html(result, wishes, chosen) + left_out + _extremes(result, wishes, chosen)


def _extremes(result: h5py.File, wishes: Wishes, chosen: DefaultCurves) -> str:
    """The table of what the curves and reactions reach."""
    rows = extremes(result, wishes, chosen.quantities)
    head = "<tr><th>quantity</th><th>unit</th><th>least</th><th>largest</th></tr>"
    cells = (f"<tr>{''.join(f'<td>{shown_html(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return f'<h2>Extremes</h2><table class="extremes">{head}{"".join(cells)}</table>' if rows else ""


def curves_html(result: h5py.File, wishes: Wishes = AS_STORED, chosen: DefaultCurves | None = None) -> str:
    """Curves, the default ones if none are chosen, a panel for each unit."""
    chosen, rows = chosen or default_curves(result), len(result["time"])
    if not chosen.quantities or not rows:
        return ""
    time = next(quantity for quantity in names(result) if quantity.name == "time")
    drawn = panels([Source("", result, slice(0, rows), time, chosen.quantities, True)], wishes)
    figures = [
        curve_figure(_visible(panel), lines_visible(panel.y_label), k) for k, panel in enumerate(drawn)
    ]
    cut = (
        f"<p>{shown_html(each[0].upper() + each[1:])}; flexmb plot with NAMEs draws others.</p>"
        for each in chosen.cut
    )
    return "<h2>Curves</h2>" + "".join((*figures, *cut))


def _visible(panel: Panel) -> Panel:
    """The panel with names that can be shown."""
    curves = tuple(replace(curve, label=lines_visible(curve.label)) for curve in panel.curves)
    return replace(panel, curves=curves, x_label=lines_visible(panel.x_label))


def _left_out(result: h5py.File) -> str:
    still = still_energies(result)
    return f"<p>Not drawn, for they do not change: {shown_html(', '.join(still))}.</p>" if still else ""


def _status(result: h5py.File) -> str:
    notes = "".join(f'<p class="failed">{shown_html(note.message)}</p>' for note in remarks(result))
    if shortfall(result):
        return notes
    time = result["time"][:]
    span = f", t = {time[0]:g} to {time[-1]:g} s" if len(time) else ""
    return f"{notes}<p>Complete: {len(time)} rows{span}.</p>"


def _audit(result: h5py.File) -> list[tuple[str, str]]:
    """Return (name, number) of every figure about the accuracy of the result."""
    items = []
    for name, dataset in result["audit"].items() if "audit" in result else ():
        if isinstance(dataset, h5py.Dataset) and is_number(dataset) and dataset.size:
            values = dataset[()]
            what = f"{attribute(dataset, 'long_name', name)} [{attribute(dataset, 'units', '1')}]"
            items.append((what, f"largest {np.max(values):.3g}, mean {np.mean(values):.3g}"))
    if "energy/total" in result and len(result["energy/total"]):
        total, kinetic = result["energy/total"][:], result["energy/kinetic"][:]
        drift = np.max(np.abs(total - total[0]))
        items.append(
            ("drift of the total energy [J]", f"{drift:.3g}; kinetic energy up to {kinetic.max():.3g}")
        )
    return items


def _run(result: h5py.File) -> list[tuple[str, str]]:
    attributes = ("deck_name", "deck_sha256", "dialect", "analysis", "status", "message", "flexmb_version")
    items = [(name.replace("_", " "), attribute(result, name)) for name in attributes]
    items.append(("set by --set", ", ".join(settings_of(result))))
    items.append(("solved with", ", ".join(settings_of(result, "options"))))
    items += [
        (f"{kind}s", f"{len(result[kind + '/name'])}: " + ", ".join(texts(result[kind + "/name"])[:40]))
        for kind in ("body", "joint", "driver", "point", "coordinate") if f"{kind}/name" in result
    ]  # fmt: skip
    return [(what.replace("bodys", "bodies"), reported) for what, reported in items if reported]


def _deck(result: h5py.File) -> str:
    dataset = result["deck"]
    if not isinstance(dataset, h5py.Dataset) or not is_text(dataset) or dataset.shape:
        raise Damaged("/deck is not a text")
    return str(dataset.asstr(errors="replace")[()])


def _changes(result: h5py.File) -> str:
    settings = settings_of(result)
    if not settings:
        return ""
    return f"<p>Numbers changed for this run by --set: <b>{shown_html(', '.join(settings))}</b></p>"


def _echo(result: h5py.File) -> str:
    """Every number of the deck with its meaning, folded; the text alone where it cannot be read."""
    name, digest, dialect = (attribute(result, key) for key in ("deck_name", "deck_sha256", "dialect"))
    text = DeckText(name, _deck(result), digest)
    # Those of variables are in the text.
    settings = [setting for setting in settings_of(result) if "." in setting.partition("=")[0]]
    try:
        reported = echo(apply_settings(read_deck(text, dialect), settings))
    except DeckError as failure:
        return f"<p>This deck cannot be read: {shown_html(str(failure))}</p>"
    return ECHO.format(AS_CHANGED if settings else AS_TYPED, shown_html(reported))


def shown_html(text: str) -> str:
    """HTML that shows `text`, with a mark for what turns the direction of writing or cannot be printed."""
    return escape(lines_visible(text.replace("\r\n", "\n")))


def _table(pairs: list[tuple[str, str]]) -> str:
    cells = (
        f'<tr><th>{shown_html(what)}</th><td class="number">{shown_html(reported)}</td></tr>'
        for what, reported in pairs
    )
    return f"<table>{''.join(cells)}</table>"


def json_text(figures: dict[Any, Any]) -> str:
    """JSON that no HTML reader can take for markup."""
    text = json.dumps(figures, separators=(",", ":"), ensure_ascii=True, allow_nan=False)
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")


def script_hash(script: str) -> str:
    """Return the source expression of a script (Content Security Policy level 3, section 2.3.1)."""
    digest = hashlib.sha256(script.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"
