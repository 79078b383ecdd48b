"""Write docs/gallery/: an index with thumbnails, and pages with curves and key numbers of every deck."""

import re
from pathlib import Path

import h5py
import numpy as np
from deck_picture import draw
from deck_runs import DOCS, TOP, checked, flexmb, solved

PAGES = DOCS / "gallery"
PICTURES = DOCS / "pictures" / "gallery"
LOOK = TOP / "flexmb_cli" / "results" / "figures"
DRAWING = [Path(__file__).with_name("deck_picture.py"), *LOOK.rglob("*.*")]
BREAK = "_\u200b"  # where long names may break
# Page: title, folder, pattern.
GROUPS = {
    "young": ("Kinematics of YOUNG decks", "young", "*.dat"),
    "dynamics": ("Dynamics of YOUNG decks", "young/dynamics", "*.dat"),
    "dafms": ("DAFMS decks", "dafms", "**/*.DAT"),
    "vsdf": ("VSDF decks", "vsdf", "*.vsdf"),
}
# Sections of the index: title, and decks from the most striking one on; the last section has all others.
SECTIONS = {
    "Machines": (
        "slider_crank_stress IN-MACHINE IN-BREAK IN-ANDREWS IN-BRICARD IN-CAM IN-ROLL IN-PID IN-RAIL IN-BALL "
        "IN-ELEMENTS motor_gear IN-ARM"
    ),
    "Finite-element bodies": (
        "strap_fine blade shell_panel frame_on_shaft beam_on_crank slider_crank_flex.vsdf spinup "
        "pendulum_ccx freeflying rotor hinge_moment beam_elements pendulum_dmig pendulum.vsdf pendulum_abq "
        "pendulum_hb pendulum_op4 pendulum_pinned strap_medium strap_coarse"
    ),
    "Linkages": (
        "IN4-BAR IN-RSSR IN5BODY IN-PATH fourbar_rigid IN4-BAR-MASS IN-RSSR-MASS IN-RSSR-COELHO IN-PAIR "
        "driven_pair IN-HOLD IN-CATCH IN-LINK arm_elements"
    ),
    "Trees of flexible beams": (
        "fourbar_flex slider_crank_flex.dat two_link_n4 spinning_beams spatial_flex arm_nrot stiff_arm "
        "shaft_beam_n10 shaft_beam_n10_unco shaft_beam_n5 shaft_beam_n2 two_link_n2 "
        "two_link_n2_unco spatial_rigid sliding_mass pendulum.dat pendulum_strict IN-SPRING"
    ),
    "A joint or a body alone": "",
}
HEAD = """# Gallery

Every supplied deck, the most striking first. The picture leads to curves and key numbers, "live" to the
page that `flexmb report` writes: play the motion and turn it. `flexmb examples NAME` copies a deck with its
files.
"""
HEAD_OF_PAGE = """
A frame of the film of `flexmb report --movie`, the curves that `flexmb plot` draws by default, and key
numbers.
"""
LIVE = DOCS / "_build" / "extra" / "live"  # pages that the build copies to live/ of the site
# What the entry of a deck states, and its card does not.
ANALYSES = ("Forward: ", "Inverse: ", "A given motion: ")
COLOURS = """Finite-element bodies are coloured by von Mises stress, those without a card `MATL` by their
deformation; the straps by values up to that at the hole, which their joints exceed. Bodies with shapes
(`GEOM`) look like these.
"""


def gallery() -> None:
    """Solve all decks that are not kept, draw those whose pictures are older, and write the pages."""
    for folder in (PICTURES, PAGES, LIVE):
        folder.mkdir(parents=True, exist_ok=True)
    groups = {page: decks_of(page) for page in GROUPS}
    decks = [deck for group in groups.values() for deck in group]
    results, records = solved(decks), checked(decks)
    for page, group in groups.items():
        text = [f"# {GROUPS[page][0]}", HEAD_OF_PAGE, *[COLOURS] * (page == "vsdf")]
        text += [_entry(deck, results[deck], records[deck]) for deck in group]
        _write(page, text)
    tree = "\n".join(["```{toctree}", ":hidden:", "", *GROUPS, "```", ""])
    _write("index", [HEAD, *(_cards(title, group) for title, group in sections(decks).items()), tree])


def sections(decks: list[Path]) -> dict[str, list[Path]]:
    """Return the decks of each section, in its order; decks that no section names are in the last one."""
    known = {name: deck for deck in decks for name in (deck.stem, _name(deck))}
    named = {title: [known[name] for name in names.split()] for title, names in SECTIONS.items()}
    listed = {deck for group in named.values() for deck in group}
    named[list(SECTIONS)[-1]] = [deck for deck in decks if deck not in listed]
    return named


def decks_of(page: str) -> list[Path]:
    """Return the decks of a page by the alphabet."""
    _, where, pattern = GROUPS[page]
    return sorted((TOP / "decks" / where).glob(pattern))


def _write(page, text):
    (PAGES / f"{page}.md").write_text("\n".join(text), encoding="utf-8")


def _cards(title, group):
    cards = [
        f":::{{grid-item-card}} {deck.stem.replace('_', BREAK)}\n"
        f":img-top: ../pictures/gallery/{_name(deck)}.png\n"
        f":link: gallery-{_name(deck)}\n:link-type: ref\n:link-alt: {deck.name}\n\n"
        f"{_sentence(deck)}\n\n{_live(deck)}\n:::\n"
        for deck in group
    ]
    grid = "::::{grid} 1 2 3 3\n:gutter: 3\n:class-container: machines\n\n"
    return f"## {title}\n\n{grid}{''.join(cards)}::::\n"


def _sentence(deck):
    words = purpose(deck)
    for analysis in ANALYSES:
        words = words.removeprefix(analysis)
    return f"{words[:1].upper()}{words[1:]}"


def _live(deck):
    return f'<a class="live" href="../live/{_name(deck)}.html">live</a>'


def _name(deck):
    return f"{deck.stem}{deck.suffix.lower()}"


def _entry(deck, result, record):
    name = _name(deck)
    mechanism, curves = PICTURES / f"{name}.png", PICTURES / f"{name}-curves.png"
    if not mechanism.exists() or mechanism.stat().st_mtime < max(map(_changed, (result, *DRAWING))):
        curves.unlink(missing_ok=True)
        draw(result, mechanism, curves)
    page = LIVE / f"{name}.html"
    if not page.exists() or page.stat().st_mtime < _changed(mechanism):
        flexmb("report", result, "-q", "-o", page)
    with h5py.File(result) as file:
        numbers = key_numbers(file, record)
        if not curves.exists():
            numbers.append(("curves", "none: nothing moves"))
    rows = "\n".join(f"| {name} | {value} |" for name, value in numbers)
    shown = [_image(mechanism, f"Mechanism of {deck.name}")]
    shown += [_image(curves, f"Curves of {deck.name}")] * curves.exists()
    return (
        f"(gallery-{name})=\n\n## {deck.name}\n\n{purpose(deck)} {_live(deck)}\n\n"
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
