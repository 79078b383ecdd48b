"""Write docs/reference/messages.md: the stable identifier of every fault, with its words of today.

python docs/_ext/fault_messages.py
"""

from collections import Counter
from functools import cache
from pathlib import Path

from fault_calls import TOP, identifier, sites
from fault_words import words

PAGE = TOP / "docs" / "reference" / "messages.md"
# Identifiers of faults that are no longer reported, and what took their place; none is given again.
RETIRED = {
    "CLI-112": "", "SOLVE-231": "", "DAFMS-076": "DECK-066", "YOUNG-155": "DECK-066",
    "DAFMS-184": "DAFMS-173", "SOLVE-004": "SOLVE-042", "VSDF-177": "", "VSDF-178": "",
    "DECK-015": "", "DECK-017": "",
    "FE-014": "FE-252", "FE-017": "FE-199", "FE-107": "FE-253", "FE-132": "FE-139",
    "RESULT-056": "", "RESULT-060": "", "RESULT-068": "", "RESULT-074": "",
    "FE-035": "FE-199", "FE-098": "FE-054",
    "FE-198": "", "FE-203": "FE-202", "MODEL-009": "SOLVE-028", "MODEL-014": "MODEL-015",
    "RUN-006": "RESULT-007", "RUN-011": "", "RUN-027": "MODEL-017", "RUN-029": "", "RUN-032": "",
    "RUN-033": "", "YOUNG-062": "", "YOUNG-105": "ELEMENTS-012", "YOUNG-106": "ELEMENTS-014",
    "YOUNG-107": "ELEMENTS-063",
    "YOUNG-108": "ELEMENTS-016", "YOUNG-109": "ELEMENTS-017", "YOUNG-110": "ELEMENTS-018",
    "YOUNG-111": "ELEMENTS-019", "YOUNG-112": "ELEMENTS-020", "YOUNG-113": "ELEMENTS-021",
    "YOUNG-114": "ELEMENTS-022", "YOUNG-115": "ELEMENTS-023", "YOUNG-116": "ELEMENTS-001",
    "YOUNG-117": "ELEMENTS-003", "YOUNG-118": "ELEMENTS-045", "YOUNG-119": "ELEMENTS-046",
    "YOUNG-120": "ELEMENTS-002", "YOUNG-124": "ELEMENTS-039", "YOUNG-125": "ELEMENTS-008",
    "YOUNG-126": "ELEMENTS-058", "YOUNG-127": "ELEMENTS-039", "YOUNG-128": "ELEMENTS-006",
    "YOUNG-129": "ELEMENTS-011", "YOUNG-153": "", "YOUNG-154": "", "SOLVE-037": "SOLVE-026",
    "DAFMS-023": "DECK-001", "DAFMS-025": "DAFMS-172", "DAFMS-026": "", "DAFMS-027": "DAFMS-061",
    "DAFMS-028": "DECK-001", "DAFMS-029": "DECK-001", "VSDF-039": "DECK-001", "VSDF-040": "VSDF-081",
    "YOUNG-027": "DECK-001", "YOUNG-028": "DECK-001", "YOUNG-160": "DECK-001", "YOUNG-161": "",
    "YOUNG-162": "",
    # Each of these stood for many messages, which have identifiers of their own now.
    "DAFMS-030": "DAFMS-001 to DAFMS-003", "DAFMS-150": "DAFMS-173, DAFMS-182, DAFMS-183, DAFMS-189",
    "DAFMS-151": "DAFMS-174 to DAFMS-181, MODEL-017", "DIFF-012": "DIFF-011, DIFF-036",
    "FE-008": "FE-058, FE-073, FE-074", "FE-029": "FE-087 to FE-131",
    "RESULT-025": "RESULT-053 to RESULT-055, RESULT-067 to RESULT-075",
    "RESULT-026": "RESULT-057 to RESULT-063",
    "SOLVE-023": "SOLVE-046 to SOLVE-059", "SOLVE-024": "SOLVE-046 to SOLVE-059",
    "STUDY-013": "STUDY-033 to STUDY-053", "VSDF-150": "VSDF-170 to VSDF-176",
    "VSDF-151": "VSDF-179 to VSDF-181, MODEL-018, MODEL-019", "VSDF-172": "",
    "YOUNG-151": "YOUNG-163, YOUNG-166 to YOUNG-168, MODEL-018, MODEL-019",
    "YOUNG-152": "YOUNG-164, YOUNG-165",
    # Of the cards of elements that the block replaces.
    "ELEMENTS-004": "ELEMENTS-045", "ELEMENTS-005": "ELEMENTS-046", "ELEMENTS-007": "ELEMENTS-039",
    "ELEMENTS-009": "ELEMENTS-058", "ELEMENTS-010": "ELEMENTS-039", "ELEMENTS-015": "ELEMENTS-063",
    "ELEMENTS-024": "ELEMENTS-047", "ELEMENTS-028": "ELEMENTS-037", "DAFMS-077": "ELEMENTS-056",
    "DAFMS-078": "DAFMS-194", "DAFMS-080": "DAFMS-193", "DAFMS-082": "ELEMENTS-034",
    "DAFMS-083": "ELEMENTS-033", "DAFMS-084": "DAFMS-192", "DAFMS-086": "ELEMENTS-052",
    "VSDF-101": "VSDF-214", "VSDF-102": "", "VSDF-105": "VSDF-215", "VSDF-104": "MODEL-062",
    "FE-057": "FE-142", "FE-254": "", "FE-255": "",
}  # fmt: skip
# How every reader refuses a word that is no number (`deck/number.py`), and what it warns of.
NUMERAL = (
    "must be a number; read … / must be an integer; read … / must be a number of at most 1.8e308 in size; "
    "read … / must be 0 or at least 5e-324 in size; read … / must be an integer of at most 15 digits; read …"
)
TAKEN_FOR = "…: … is taken for …; write the exponent with e / … should be an integer; … is taken for …"
# Identifiers of classes that write decks of the three dialects.
NOT_CONVERTED = (
    "its function of time is not converted: … has no card of …; give it as a table, a spline, a "
    "polynomial or a sine"
)
# Messages whose words come from elsewhere: an exception, a library, the file at fault.
WORDS = {
    "CLI-002": "a fault of flexmb itself: …: …",
    "CLI-003": "No such option: … / Missing argument '…' / Missing option '…' / Invalid value for '…': …",
    "CLI-006": "nothing to draw: no rows in this window of time / it has no rows / the run is not …",
    "CLI-031": "…: a curve needs one parameter that varies, these do: …; take --kind scatter / "
    "…: a map needs two parameters with every pair of values solved; take --kind scatter",
    "CLI-034": "--width: letters of … points leave no room for curves in … mm: choose a wider picture, "
    "smaller letters or fewer curves",
    "CLI-035": "--style …: text.usetex starts LaTeX, another program: give --latex, too / "
    "--style …: no such file, and no style of matplotlib, such as …, has this name",
    "DAFMS-174": NOT_CONVERTED,
    "DECK-001": "… must be …; read … / … must be …; Enter gives none here",
    "DECK-002": TAKEN_FOR,
    "DECK-016": f"--set …: … {NUMERAL}",
    "DECK-053": "cannot be read: …",
    "DECK-057": "--set …: write NAME=VALUE, such as time.end=2.5",
    "DECK-058": "--set …: the deck has no number …; …",
    "DECK-059": "--set …: a count cannot be set: the deck's layout depends on it",
    "DIFF-016": "line …: could not convert string to float: …",
    "DIFF-030": "written by flexmb … in the layout …; this flexmb reads layouts up to …",
    "ELEMENTS-041": f"file …: … {NUMERAL}",
    "FE-023": "…: no such file in …",
    "RESULT-021": "…: the result has no such quantity; …; flexmb table RESULT.h5 --list shows all",
    "RESULT-022": "/… cannot be read: …",
    "RESULT-077": "numbers of the program YOUNG of 1996 with its known errors (--as-printed), "
    "not of the mechanism",
    "RESULT-078": "the run is not complete, its rows end at t = … s / "
    "the run is not complete, it has no rows",
    "SOLVE-044": "… is not used for compiled kernels: …",
    "SOLVE-045": "… is damaged: … / … cannot be read (…): …",
    "SOLVE-059": "at t = … s the motion passes a singular position… / close to a singular position… / "
    "near t = … s the motion passes a singular position of … (…), where it could branch; "
    "it continues smoothly",
    "SOLVE-061": "a function changes between … and … s; of a driver's rate that is a jump, an impulse, which "
    "no steps resolve: move these two times apart, by … s or more, or use STEP",
    "STUDY-011": "not TOML: …",
    "STUDY-014": "the deck has no number …; …",
    "STUDY-016": "…: the result has no such quantity; …",
    "VSDF-016": "no row stands at the end … s: the last within whole steps is at … s",
    "VSDF-040": f"each number / of the nodes {NUMERAL}",
    "VSDF-081": f"… in columns … / in field … {NUMERAL}",
    "VSDF-082": TAKEN_FOR,
    "VSDF-170": NOT_CONVERTED,
    "YOUNG-020": f"… {NUMERAL}",
    "YOUNG-021": TAKEN_FOR,
    "YOUNG-025": "…: … coordinates, … equations, … too many / too few",
    "YOUNG-031": "… numbers are expected (… … …), … is not a number of this table… / "
    "… numbers are expected (… … …), … are there…",
    "YOUNG-056": f"… {NUMERAL}",
    "YOUNG-057": TAKEN_FOR,
    "YOUNG-165": NOT_CONVERTED,
    "YOUNG-162": f"… {NUMERAL}",
}
HEAD = """# Messages

Every message has an identifier that stays the same when its words change: with `--json` it is the key `id`
of a fault. An identifier that is no longer used is not given to another message. `…` stands for what depends
on the input, and ` / ` between words of which a message has one or the other. An error may end with the
numbers changed by `--set`. `python docs/_ext/fault_messages.py` makes this page; tests compare it with
the program.

| identifier | message |
|---|---|
"""
TAIL = """
## Identifiers that are no longer used

| identifier | replaced by |
|---|---|
"""


def proposal(path: Path) -> str:
    """Return the next free identifier for a fault in a file, of the area of the faults nearest to it."""
    given = [(site.path, name) for site in sites() if (name := identifier(site))]
    for place in (path, *path.parents):
        areas = Counter(name.partition("-")[0] for file, name in given if file.is_relative_to(place))
        if areas:
            area = areas.most_common(1)[0][0]
            taken = {name for _, name in given} | set(RETIRED)
            return next(name for n in range(1, 1000) if (name := f"{area}-{n:03d}") not in taken)
    raise ValueError(f"{path} is in no folder with faults")


@cache
def messages() -> dict[str, list[str]]:
    """Return the different texts of every identifier."""
    found: dict[str, list[str]] = {}
    for site in sites():
        name = identifier(site)
        if name:
            texts = found.setdefault(name, [])
            texts += [text for text in (WORDS.get(name) or words(site),) if text not in texts]
    return found


def page() -> str:
    """Return the text of the page."""
    rows = (
        f"| {name} | {' / '.join(texts).replace('|', chr(92) + '|')} |\n"
        for name, texts in sorted(messages().items())
    )
    gone = (f"| {name} | {successor} |\n" for name, successor in sorted(RETIRED.items()))
    return HEAD + "".join(rows) + TAIL + "".join(gone)


def listed(text: str) -> set[str]:
    """Return the identifiers that a text of the page lists, used or not."""
    return {line.split(" ")[1] for line in text.splitlines() if line.startswith("| ") and "-" in line}


def write(path: Path = PAGE) -> None:
    """Write the page anew; refused if an identifier of the page that is there would be lost."""
    lost = listed(path.read_text(encoding="utf-8")) - listed(page()) if path.exists() else set()
    if lost:
        raise SystemExit(f"enter in RETIRED what is no longer reported: {', '.join(sorted(lost))}")
    path.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    write()
