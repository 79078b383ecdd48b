"""Pieces of the page: tables, pictures, text; everything from files is escaped."""

import html
from dataclasses import dataclass, field
from pathlib import Path

WIDTH = 6.4  # of figures, inches: their letters stay readable on a phone

STYLE = """
body { font: 15px/1.5 Georgia, serif; max-width: 60em; margin: 2em auto; padding: 0 1em; color: #222 }
h1, h2, h3, table, figcaption { font-family: Helvetica, Arial, sans-serif }
table { border-collapse: collapse; margin: 1em 0; font-size: 13px }
th, td { padding: .25em .7em; border-bottom: 1px solid #ddd; text-align: left; vertical-align: top }
td.n { text-align: right; font-variant-numeric: tabular-nums }
figure { margin: 1em 0 } img { max-width: 100% } figcaption { font-size: 13px; color: #555 }
"""


@dataclass
class Section:
    """A part of the page, filled piece by piece."""

    title: str
    pieces: list[str] = field(default_factory=list)
    markdown: list[str] = field(default_factory=list)

    def text(self, sentence: str) -> None:
        """A paragraph; line ends do not matter."""
        sentence = " ".join(sentence.split())
        self.pieces.append(f"<p>{html.escape(sentence)}</p>")
        self.markdown.append(_plain(sentence))

    def heading(self, words: str) -> None:
        """A heading below the section's."""
        self.pieces.append(f"<h3>{html.escape(words)}</h3>")
        self.markdown.append(f"### {_plain(words)}")

    def table(self, head, rows) -> None:
        """A table; cells that begin like numbers stand on the right."""
        top = "".join(f"<th>{html.escape(str(cell))}</th>" for cell in head)
        body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows)
        self.pieces.append(f"<table><tr>{top}</tr>{body}</table>")
        lines = (map(str, head), ("---" for _ in head), *(map(str, row) for row in rows))
        self.markdown.append("\n".join(f"| {' | '.join(map(_plain, line))} |" for line in lines))

    def picture(self, folder: Path, name: str, figure, caption: str) -> None:
        """A matplotlib figure, written to `folder`."""
        figure.savefig(folder / name, dpi=160, metadata={"Software": None})
        self.markdown.append(
            f"```{{figure}} ../pictures/{folder.name}/{name}\n:alt: {_plain(caption)}\n{_plain(caption)}\n```"
        )
        caption = html.escape(caption)
        self.pieces.append(
            f'<figure><img src="{name}" alt="{caption}"><figcaption>{caption}</figcaption></figure>'
        )

    def __str__(self):
        return f"<h2>{html.escape(self.title)}</h2>\n" + "\n".join(self.pieces)


def _cell(value):
    text = str(value)
    number = text[:1] in "+-0123456789" and text != "-"
    return f'<td class="n">{html.escape(text)}</td>' if number else f"<td>{html.escape(text)}</td>"


def _plain(text):
    """Text in which MyST sees no markup."""
    for sign in "\\|*_<>[]`$":
        text = text.replace(sign, f"\\{sign}")
    return "---" if text == "---" else text


def page(title: str, sections) -> str:
    """The whole page."""
    body = "\n".join(map(str, sections))
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{html.escape(title)}</title>'
        f"<style>{STYLE}</style><h1>{html.escape(title)}</h1>\n{body}\n</html>\n"
    )


def markdown_page(head: str, sections) -> str:
    """The same page for the documentation."""
    parts = [head]
    for section in sections:
        parts += [f"## {_plain(section.title)}", *section.markdown]
    return "\n\n".join(parts) + "\n"
