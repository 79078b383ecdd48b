"""Message about a name that a result does not have: near names, or why it has none of that type."""

import re
from collections.abc import Sequence
from difflib import SequenceMatcher

from .quantity_names import Family, Slot, folded

NAMES_SHOWN = 3
LEAST_LIKENESS = 0.6
# No word is compared with more labels of an axis: those of large models differ by numbers only.
LABELS = 200


def nearest(words: Sequence[str], forms: Sequence[Sequence[Sequence[str]]]) -> list[str]:
    """At most three names near `words`; a form of names is a list of words to choose from for every place."""
    scored = [_best(words, form) for form in forms]
    scored = [(likeness, name) for likeness, name in scored if likeness >= LEAST_LIKENESS]
    ordered = dict.fromkeys(name for _, name in sorted(scored, key=lambda pair: -pair[0]))
    return list(ordered)[:NAMES_SHOWN]


def _best(words: Sequence[str], form: Sequence[Sequence[str]]) -> tuple[float, str]:
    chosen = [_closest(word, choices) for word, choices in zip(words, form, strict=False)]
    # A name with more words than were given stands for all of them.
    total = sum(likeness for likeness, _ in chosen) / max(len(words), len(chosen), 1)
    return total, ".".join(word for _, word in chosen)


def _closest(word: str, choices: Sequence[str]) -> tuple[float, str]:
    if word in choices:
        return 1.0, word
    return max(((_likeness(word, choice), choice) for choice in choices[:LABELS]), key=lambda pair: pair[0])


def _likeness(word: str, choice: str) -> float:
    if word.isdigit() and choice.isdigit():
        # A number out of range is a near miss whatever its digits.
        return 0.5
    return SequenceMatcher(None, word.lower(), choice.lower()).ratio()


FORCES = "in a YOUNG deck DYNAMICS inverse or DYNAMICS forward"
TREE, FLEXIBLE = (
    "coordinate/u_rate",
    "energy/strain",
)  # what results of trees have, and those of VSDF decks, too
# What a deck needs for the quantities that begin with a word.
NEEDS = {
    "coordinate": "joint coordinates need a joint that turns about one axis, or slides along one",
    "reaction": f"reactions need masses: {FORCES}",
    "driver": f"efforts of drivers need masses: {FORCES}",
    "energy": f"energies need masses: {FORCES}",
    "element": f"elements need lines such as SPRING or BUSHING in a block ELEMENTS: {FORCES}",
    "load": "applied forces need lines FORCE or TORQUE in a block ELEMENTS, or cards FORC and TOQU of DAFMS",
    "elastic": "elastic displacements need a flexible body",
    "modal": "modal amplitudes need a flexible body",
    "stress": "stresses need the cards MATL and OUTS of a VSDF deck",
    "strain": "strains need the cards MATL and OUTS of a VSDF deck",
}
OF_TREES = {
    "reaction": "a tree has reactions of closed loops only, and this one has none",
    "driver": "efforts of drivers need a prescribed coordinate, card PRES or line DRIVE",
    "element": "elements need lines such as SPRING, STOP or BUSHING in a block ELEMENTS",
}
OF_VSDF = {
    "reaction": "reactions need joints, cards JOIN",
    "driver": "efforts of drivers need the card MOTN",
    "element": "elements need lines such as SPRING or BUSHING in a block ELEMENTS",
}
_IN_BRACKETS = re.compile(r"\[(\d+)\]")


def hint_for(pattern: str, families: Sequence[Family]) -> str:
    """Return what may be meant by `pattern`, or what the result lacks; "" where nothing is known."""
    if spelled := _with_points(pattern, families):
        return f"names are written with points, such as {spelled}"
    words = pattern.split(".")
    if lacking := _lacking(words[0].lower(), families):
        return lacking
    if counted := _count(words, families):
        return counted
    if whose := _of_things(folded(pattern), families):
        return f"of which one? names are such as {whose}"
    close = nearest(words, [[slot.spellings for slot in form] for known in families for form in known.forms])
    return f"near it are {', '.join(close)}" if close else ""


def _with_points(pattern: str, families: Sequence[Family]) -> str:
    """Return a name for a path of a dataset or for a number in brackets."""
    for family in families:
        if family.path == pattern.strip("/"):
            return family.name((0,) * len(family.shape))
    dotted = _IN_BRACKETS.sub(r".\1", pattern)
    return dotted if dotted != pattern else ""


def _lacking(first: str, families: Sequence[Family]) -> str:
    need = next((word for word in NEEDS if first in (word, f"{word}s", f"{word}es")), None)
    if need is None or any(family.path.startswith(f"{need}/") for family in families):
        return ""
    paths = {family.path for family in families}
    of_kind = OF_TREES if TREE in paths else OF_VSDF if FLEXIBLE in paths else {}
    hint = _in_place_of_displacements(families) if need == "elastic" else ""
    return hint or of_kind.get(need, NEEDS[need])


def _in_place_of_displacements(families: Sequence[Family]) -> str:
    """Return what a result has of its flexible bodies, whose displacements are no series."""
    amplitudes = [
        one for one in families if one.path.startswith("modal/") and one.path.endswith("/amplitude")
    ]
    if not amplitudes:
        return ""
    known = ", ".join(one.name((0,)).rpartition(".")[0] for one in amplitudes)
    return (
        f"displacements of nodes are series of DAFMS bodies; this result has {known}, the amplitudes of "
        "modes, and a node on a card OUTN is a point, such as point.1.x"
    )


def _of_things(word: str, families: Sequence[Family]) -> str:
    """Return names of the first things that have a quantity named without them: body.1.velocity."""
    of_word = (family for family in families if family.path.partition("/")[2] == word)
    # The last word of a name is the component, which may be left out.
    things = [family.name((0,) * len(family.shape)).rpartition(".")[0] for family in of_word]
    return " or ".join(name for name in things if name.endswith(f".{word}"))


def _count(words: Sequence[str], families: Sequence[Family]) -> str:
    """Return how many there are where a number is too large, or 0."""
    if len(words) < 2 or not words[1].isdigit():
        return ""
    axes = [len(form[1].words) for family in families for form in family.forms if _is_numbered(form, words)]
    if not axes or 1 <= int(words[1][:9]) <= max(axes):
        return ""
    counted = f"1 to {max(axes)}" if max(axes) > 1 else "1 only"
    counting = (
        "; it counts angles and strokes in the order of the joints, cards such as ANGLE 2 count joints"
        if words[0].lower() == "coordinate" and not any(family.path == TREE for family in families)
        else ""
    )
    return f"it has {words[0].lower()} {counted}{counting}"


def _is_numbered(form: tuple[Slot, ...], words: Sequence[str]) -> bool:
    return len(form) > 1 and words[0].lower() in form[0].spellings and "1" in form[1].spellings
