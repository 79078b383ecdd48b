"""One self-contained HTML page on a result: status, animation, curves, audit, deck and its echo.

plotly.js draws: it is one file that needs no network, has curves and 3-D with frames, slider and mouse in
one library, and comes with the well-kept Python package that carries it.  The page's content security
policy names the two scripts by their hashes and forbids everything else, network included; whatever comes
from the file is escaped besides.
"""

import base64
import hashlib
import json
from html import escape
from string import Template

import h5py
import numpy as np

from ...deck.record import DeckText
from ...dialects.recognise import read_deck
from ...dialects.settings import apply_settings
from ...errors import DeckError, lines_visible
from ..hdf5.stored_result import Damaged, attribute, check_shapes, is_number, is_text, settings_of, texts
from ..quantities.quantities import ResultError, names, shortfall
from ..texts.echo import echo
from .curves import Panel, Source, default_quantities, panels, still_energies
from .report_animation import COLOURS, animation, frame_rows
from .scene import read_scene

MOST_CURVE_ROWS = 2000
AUDITED = {"time": "t", "energy/total": "t", "energy/kinetic": "t"}

SCRIPT = """
const figures = JSON.parse(document.getElementById("figures").textContent);
const config = {responsive: true, displaylogo: false,
  modeBarButtonsToRemove: ["sendChartToCloud", "downloadJson"]};
window.flexmb = {ready: false, frames: figures.animation ? figures.animation.frames.length : 0};
async function draw() {
  if (figures.animation) {
    const {data, layout, frames} = figures.animation;
    await Plotly.newPlot("animation", data, layout, config);
    await Plotly.addFrames("animation", frames);
  }
  for (const [k, curves] of figures.curves.entries())
    await Plotly.newPlot("curves" + k, curves.data, curves.layout, config);
  window.flexmb.ready = true;
}
draw();
"""

PAGE = Template("""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src $hashes; \
style-src 'unsafe-inline'; img-src data: blob:; font-src data:">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>$title</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; color: #222; }
body { max-width: 1100px; margin: 1.5em auto; padding: 0 1em; }
h1 { font-size: 1.5em; } h2 { font-size: 1.15em; margin-top: 2em; border-bottom: 1px solid #ccc; }
table { border-collapse: collapse; }
td, th { padding: .15em 1em .15em 0; text-align: left; vertical-align: top; }
th { white-space: nowrap; }
td.number { font-family: ui-monospace, monospace; }
pre { background: #f6f6f6; padding: 1em; overflow: auto; max-height: 40em; }
summary { cursor: pointer; }
.failed { background: #fdecea; border-left: 4px solid #c00; padding: .5em 1em; }
#animation { height: 640px; } .curves { height: 360px; }
</style>
</head>
<body>
<h1>$title</h1>
$status
$animation
$curves
<h2>Audit</h2>
$audit
<h2>Run</h2>
$run
<h2>Deck</h2>
$changes
<pre>$deck</pre>
$echo
<script id="figures" type="application/json">$figures</script>
<script>$library</script>
<script>$script</script>
</body>
</html>
""")


def report_page(result: h5py.File, library: str) -> str:
    """The page on `result`, with `library`, the text of plotly.js.

    Raises `ResultError` when the file has no deck.
    """
    if "deck" not in result:
        raise ResultError(result.filename, "this is no result of a run: it has no deck", id="RESULT-001")
    moving = _animation(result)
    drawn = _curves(result)
    check_shapes(result, AUDITED, {})
    name = attribute(result, "deck_name")
    return PAGE.substitute(
        hashes=" ".join(map(_hash, (library, SCRIPT))),
        title=_shown(f"{name}: {attribute(result, 'dialect')} {attribute(result, 'analysis')}"),
        status=_status(result),
        animation=ANIMATION if moving else "<p>There are no rows to draw.</p>",
        curves="".join(
            f'<h2>Curves</h2><div class="curves" id="curves{k}"></div>' if k == 0
            else f'<div class="curves" id="curves{k}"></div>' for k in range(len(drawn))
        ) + _left_out(result),
        audit=_table(_audit(result)),
        run=_table(_run(result)),
        changes=_changes(result),
        deck=_shown(_deck(result)),
        echo=_echo(result),
        figures=_json({"animation": moving, "curves": drawn}),
        library=library,
        script=SCRIPT,
    )  # fmt: skip


ECHO = """<details id="echo"><summary>Every number of the deck: line, name, value, unit, meaning</summary>
<p>{}</p>
<pre>{}</pre></details>"""
AS_TYPED = "As the deck's text has them."
AS_CHANGED = "As this run had them; what --set changed has that word in place of its line."

ANIMATION = """<h2>Motion</h2>
<div id="animation"></div>
<p>Drag to turn, scroll to come nearer, click a name to hide it, click it twice to see it alone.</p>"""


def _animation(result):
    rows = len(result["time"])
    if not rows or "body/position" not in result:
        return None
    places = len(read_scene(result, slice(0, 1)).places)
    return animation(read_scene(result, frame_rows(rows, places)))


def _curves(result):
    """Figures of the default curves, a panel each."""
    quantities = default_quantities(result)
    rows = len(result["time"])
    if not quantities or not rows:
        return []
    every = slice(0, rows, -(-rows // MOST_CURVE_ROWS))
    time = next(quantity for quantity in names(result) if quantity.name == "time")
    return [_figure(panel) for panel in panels([Source("", result, every, time, quantities, True)])]


def _left_out(result):
    still = still_energies(result)
    return f"<p>Not drawn, for they do not change: {_shown(', '.join(still))}.</p>" if still else ""


def _figure(panel: Panel):
    data = [
        {
            "type": "scatter", "mode": "lines", "name": _shown(curve.label),
            "line": {"color": COLOURS[k % len(COLOURS)], "dash": ("solid", "dash")[k // len(COLOURS) % 2]},
            "x": _short(curve.x), "y": _short(curve.y),
        }
        for k, curve in enumerate(panel.curves)
    ]  # fmt: skip
    layout = {
        "margin": {"l": 80, "r": 20, "t": 20, "b": 50},
        "xaxis": {"title": {"text": _shown(panel.x_label)}},
        "yaxis": {"title": {"text": _shown(panel.y_label)}, "exponentformat": "power", "automargin": True},
        "showlegend": True,
        "hovermode": "closest",
    }
    return {"data": data, "layout": layout}


def _short(values):
    """Seven digits are more than a screen shows."""
    return [float(f"{value:.7g}") if np.isfinite(value) else None for value in values.tolist()]


def _status(result):
    told = shortfall(result)
    if told:
        return f'<p class="failed">{_shown(told)}</p>'
    time = result["time"][:]
    span = f", t = {time[0]:g} to {time[-1]:g} s" if len(time) else ""
    return f"<p>Complete: {len(time)} rows{span}.</p>"


def _audit(result):
    """(what, number) of everything that tells how good the numbers are."""
    found = []
    for name, dataset in result["audit"].items() if "audit" in result else ():
        if isinstance(dataset, h5py.Dataset) and is_number(dataset) and dataset.size:
            values = dataset[()]
            what = f"{attribute(dataset, 'long_name', name)} [{attribute(dataset, 'units', '1')}]"
            found.append((what, f"largest {np.max(values):.3g}, mean {np.mean(values):.3g}"))
    if "energy/total" in result and len(result["energy/total"]):
        total, kinetic = result["energy/total"][:], result["energy/kinetic"][:]
        drift = np.max(np.abs(total - total[0]))
        found.append(
            ("drift of the total energy [J]", f"{drift:.3g}; kinetic energy up to {kinetic.max():.3g}")
        )
    return found


def _run(result):
    attributes = ("deck_name", "deck_sha256", "dialect", "analysis", "status", "message", "flexmb_version")
    found = [(name.replace("_", " "), attribute(result, name)) for name in attributes]
    found.append(("set by --set", ", ".join(settings_of(result))))
    found.append(("solved with", ", ".join(settings_of(result, "options"))))
    found += [
        (f"{kind}s", f"{len(result[kind + '/name'])}: " + ", ".join(texts(result[kind + "/name"])[:40]))
        for kind in ("body", "joint", "driver", "point", "coordinate") if f"{kind}/name" in result
    ]  # fmt: skip
    return [(what.replace("bodys", "bodies"), told) for what, told in found if told]


def _deck(result):
    dataset = result["deck"]
    if not isinstance(dataset, h5py.Dataset) or not is_text(dataset) or dataset.shape:
        raise Damaged("/deck is no text")
    return dataset.asstr(errors="replace")[()]


def _changes(result):
    settings = settings_of(result)
    if not settings:
        return ""
    return f"<p>Numbers changed for this run by --set: <b>{_shown(', '.join(settings))}</b></p>"


def _echo(result):
    """Every number of the deck with its meaning, folded; the text alone where it cannot be read."""
    name, digest, dialect = (attribute(result, key) for key in ("deck_name", "deck_sha256", "dialect"))
    text = DeckText(name, _deck(result), digest)
    settings = settings_of(result)
    try:
        told = echo(apply_settings(read_deck(text, dialect), settings))
    except DeckError as failure:
        return f"<p>This deck cannot be read: {_shown(str(failure))}</p>"
    return ECHO.format(AS_CHANGED if settings else AS_TYPED, _shown(told))


def _shown(text):
    """HTML that shows `text`, with a mark for what turns the direction of writing or cannot be printed."""
    return escape(lines_visible(text.replace("\r\n", "\n")))


def _table(pairs):
    cells = (
        f'<tr><th>{_shown(what)}</th><td class="number">{_shown(told)}</td></tr>' for what, told in pairs
    )
    return f"<table>{''.join(cells)}</table>"


def _json(figures):
    """JSON that no HTML reader can take for markup."""
    text = json.dumps(figures, separators=(",", ":"), ensure_ascii=True, allow_nan=False)
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")


def _hash(script):
    digest = hashlib.sha256(script.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"
