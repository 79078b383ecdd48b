"""Recognition of VSDF decks by their first lines."""

import re
from collections.abc import Sequence

from ...deck.record import as_lines


def begins_vsdf(lines: Sequence[str]) -> bool:
    """The word VSDF."""
    return re.match(r"\s*VSDF", as_lines(lines).text, re.IGNORECASE) is not None
