"""A part of the page of a study, that of a fit or of tolerances."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class StudyPart:
    """`text`: HTML with the places of `figures`, which are those of plotly.js by place."""

    text: str
    figures: dict[str, Any]


def place_of(name: str) -> str:
    """Return the place of a figure."""
    return f'<div class="plot" id="{name}"></div>'


def table_html(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table of cells, which are HTML."""
    lines = [f"<tr>{''.join(f'<th>{head}</th>' for head in heads)}</tr>"]
    lines += [f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows]
    return f"<table>{''.join(lines)}</table>"
