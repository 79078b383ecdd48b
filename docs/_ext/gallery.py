"""Write docs/gallery/: an index with thumbnails, and pages with curves and key numbers of every deck."""

import re
from pathlib import Path

import h5py
import numpy as np
from deck_picture import draw
from deck_runs import DOCS, TOP, checked, solved

PAGES = DOCS / "gallery"
PICTURES = DOCS / "pictures" / "gallery"
DRAWING = Path(__file__).with_name("deck_picture.py")
BREAK = "_\u200b"  # where long names may break
# Page: title, folder, pattern.
GROUPS = {
    "young": ("Kinematics of YOUNG decks", "young", "*.dat"),
    "dynamics": ("Dynamics of YOUNG decks", "young/dynamics", "*.dat"),
    "dafms": ("DAFMS decks", "dafms", "**/*.DAT"),
    "vsdf": ("VSDF decks", "vsdf", "*.vsdf"),
}
HEAD = """# Gallery

Every supplied deck; click on one for its curves and key numbers. `flexmb examples NAME` copies a deck with
its files, `flexmb report` shows its motion. `scripts/docs` makes these pages and their pictures.
"""
HEAD_OF_PAGE = """
The mechanism at some instants (faint: earlier), the curves that `flexmb plot` draws by default, and
key numbers.
"""
COLOURS = """Finite-element bodies are coloured by von Mises stress, those without a card `MATL` by their
deformation; the straps by values up to that at the hole, which their joints exceed. Bodies with shapes
(`GEOM`) look like these.
"""


def gallery() -> None:
    """Solve all decks that are not kept, draw those whose pictures are older, and write the pages."""
    for folder in (PICTURES, PAGES):
        folder.mkdir(parents=True, exist_ok=True)
    groups = {page: decks_of(page) for page in GROUPS}
    decks = [deck for group in groups.values() for deck in group]
    results, records = solved(decks), checked(decks)
    for page, group in groups.items():
        text = [f"# {GROUPS[page][0]}", HEAD_OF_PAGE, *[COLOURS] * (page == "vsdf")]
        text += [_entry(deck, results[deck], records[deck]) for deck in group]
        _write(page, text)
    tree = "\n".join(["```{toctree}", ":hidden:", "", *GROUPS, "```", ""])
    _write("index", [HEAD, *(_thumbnails(page, group) for page, group in groups.items()), tree])


def decks_of(page: str) -> list[Path]:
    """Return the decks of a page by the alphabet."""
    _, where, pattern = GROUPS[page]
    return sorted((TOP / "decks" / where).glob(pattern))


def _write(page, text):
    (PAGES / f"{page}.md").write_text("\n".join(text), encoding="utf-8")


def _thumbnails(page, group):
    cards = [
        f":::{{grid-item-card}} {deck.stem.replace('_', BREAK)}\n"
        f":img-top: ../pictures/gallery/{_name(deck)}.png\n"
        f":link: gallery-{_name(deck)}\n:link-type: ref\n:link-alt: {purpose(deck)}\n:::\n"
        for deck in group
    ]
    grid = "::::{grid} 3 3 5 5\n:gutter: 2\n:class-container: thumbnails\n\n"
    return f"## [{GROUPS[page][0]}]({page}.md)\n\n{grid}{''.join(cards)}::::\n"


def _name(deck):
    return f"{deck.stem}{deck.suffix.lower()}"


def _entry(deck, result, record):
    name = _name(deck)
    mechanism, curves = PICTURES / f"{name}.png", PICTURES / f"{name}-curves.png"
    if not mechanism.exists() or mechanism.stat().st_mtime < max(map(_changed, (result, DRAWING))):
        curves.unlink(missing_ok=True)
        draw(result, mechanism, curves)
    with h5py.File(result) as file:
        numbers = key_numbers(file, record)
        if not curves.exists():
            numbers.append(("curves", "none: nothing moves"))
    rows = "\n".join(f"| {name} | {value} |" for name, value in numbers)
    shown = [_image(mechanism, f"Mechanism of {deck.name}")]
    shown += [_image(curves, f"Curves of {deck.name}")] * curves.exists()
    return (
        f"(gallery-{name})=\n\n## {deck.name}\n\n{purpose(deck)}\n\n"
        f":::{{div}} pictures\n{''.join(shown)}:::\n\n"
        f"| key number | value |\n|---|---|\n{rows}\n"
    )


def _image(picture, words):
    return f"```{{image}} ../pictures/gallery/{picture.name}\n:alt: {words}\n```\n"


def purpose(deck: Path) -> str:
    """What the page beside the decks says of one, as a sentence."""
    for folder in (deck.parent, deck.parent.parent):
        page = folder / "README.md"
        for line in page.read_text(encoding="utf-8").splitlines() if page.exists() else ():
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            named = re.findall(r"`([^`]*)`", cells[0])
            whole = [
                name if not name.startswith("_") else named[0].rpartition("_")[0] + name for name in named
            ]
            if len(cells) > 1 and deck.stem in whole:
                return f"{cells[1][:1].upper()}{cells[1][1:]}."
    return ""


def key_numbers(result: h5py.File, record: dict) -> list[tuple[str, str]]:
    """Counts of the model, span of time, what moves fastest, and how well equations and energy are met."""
    counts, time = record["counts"], result["time"][:]
    found = [("bodies", _bodies(counts)), *_joints(counts)]
    sizes = [key for key in ("coordinates", "equations", "degrees_of_freedom") if key in counts]
    found.append((", ".join(sizes).replace("_", " "), ", ".join(f"{counts[key]}" for key in sizes)))
    found.append(("rows, time", f"{len(time)}, {time[0]:g} … {time[-1]:g} s"))
    found += [*_frequencies(record), *_motion(result)]
    if "audit/constraint_residual" in result:
        found.append(("largest constraint residual", f"{result['audit/constraint_residual'][:].max():.1e}"))
    if "energy/total" in result:
        total, kinetic = result["energy/total"][:], result["energy/kinetic"][:]
        found.append(("change of total energy / largest kinetic", f"{_share(total, kinetic):.1e}"))
    return found


def _changed(path):
    return path.stat().st_mtime


def _bodies(counts):
    flexible = counts.get("flexible", 0)
    return f"{counts['bodies']}, {flexible} of them flexible" if flexible else f"{counts['bodies']}"


def _joints(counts):
    joints = ", ".join(f"{number} {kind}" for kind, number in counts.get("joints", {}).items())
    closures = counts.get("closures", 0)
    if joints or "joints" in counts:
        yield "joints", joints or "none"
    if closures:
        yield "loop closures", closures


def _frequencies(record):
    for body in record.get("bodies", ()):
        if body.get("frequencies"):
            first, last = body["frequencies"][0], body["frequencies"][-1]
            yield f"{body['name']}: {body['modes']} modes", f"{first:.4g} … {last:.4g} Hz"


def _motion(result):
    for group in ("point", "body"):  # hinges of a tree may rest while its bodies turn
        speeds = np.linalg.norm(result[f"{group}/velocity"][:], axis=2) if group in result else np.zeros(0)
        if speeds.size and speeds.max() > 0:
            row, k = np.unravel_index(int(speeds.argmax()), speeds.shape)
            name = result[f"{group}/name"].asstr()[k]
            yield "largest speed", f"{speeds.max():.4g} m/s, {name}, at {result['time'][row]:.4g} s"
            break
    deflections = {
        name: _deflection(result[f"elastic/{name}"], result, name) for name in result.get("elastic", ())
    }
    for name, largest in deflections.items():
        yield f"{name}: largest deflection", f"{largest:.3g} m"


def _deflection(group, result, name):
    if "displacement" in group:
        moved = group["displacement"][:]
    else:
        moved = np.einsum("nkm,tm->tnk", group["shape"][:], result[f"modal/{name}/amplitude"][::10])
    return float(np.linalg.norm(moved, axis=2).max())


def _share(total, kinetic):
    return float(np.abs(total - total[0]).max() / max(kinetic.max(), 1e-300))
