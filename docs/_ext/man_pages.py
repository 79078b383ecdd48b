"""Write docs/man/*.1, a page for the program and one for each command, from click's own data.

python docs/_ext/man_pages.py
"""

import re
from collections.abc import Iterator
from pathlib import Path

import click

from flexmb_cli import __version__
from flexmb_cli.cli import cli
from flexmb_cli.cli.__init__ import exit_codes

FOLDER = Path(__file__).resolve().parents[1] / "man"


def pages() -> dict[str, str]:
    """Return the texts of all pages by the names of their files."""
    top = click.Context(cli, info_name="flexmb", **cli.context_settings)
    found = {"flexmb.1": _page("flexmb", cli, top, _commands())}
    for name, command in cli.commands.items():
        context = click.Context(command, info_name=name, parent=top)
        found[f"flexmb-{name}.1"] = _page(name, command, context, ())
    return found


def _page(name, command, context, commands):
    title = "flexmb" if name == "flexmb" else f"flexmb-{name}"
    short = " ".join(command.help.split("\n\n")[0].split()).rstrip(".")
    lines = [f'.TH "{title.upper()}" "1" "" "flexmb {__version__}" "flexmb"']
    lines += [".SH NAME", rf"{_safe(title)} \- {_safe(short)}"]
    usage = " ".join(command.collect_usage_pieces(context))
    lines += [".SH SYNOPSIS", rf"\fB{_safe(context.command_path)}\fR {_safe(usage)}"]
    lines += [".SH DESCRIPTION", *_paragraphs(command.help)]
    lines += [".SH OPTIONS", *_options(command, context), *commands]
    lines += [".SH EXIT STATUS", *_definitions(exit_codes(name).items())]
    lines += [".SH SEE ALSO", _see_also(name)]
    return "\n".join(lines) + "\n"


def _paragraphs(text) -> Iterator[str]:
    """Paragraphs that roff fills, and those behind \\b as they are."""
    for paragraph in text.replace("\f", "").strip().split("\n\n"):
        lines = paragraph.strip("\n").split("\n")
        yield ".PP"
        if lines[0].strip() == "\b":
            yield from (".nf", *map(_safe, lines[1:]), ".fi")
        else:
            yield _safe(" ".join(line.strip() for line in lines))


def _options(command, context):
    options = (one for one in command.params if isinstance(one, click.Option))
    records = [option.get_help_record(context) for option in options]
    return _definitions([*filter(None, records), ("-h, --help", "Show this message and exit.")])


def _commands():
    lines = _definitions(
        (f"flexmb-{name}(1)", " ".join(command.help.split("\n\n")[0].split()))
        for name, command in cli.commands.items()
    )
    return (".SH COMMANDS", *lines)


def _definitions(pairs):
    for word, meaning in pairs:
        yield from (".TP", rf"\fB{_safe(word)}\fR", _safe(meaning) or r"\&")


def _see_also(name):
    others = cli.commands if name == "flexmb" else ["flexmb"]
    return ", ".join(_safe(f"flexmb-{other}(1)" if other != "flexmb" else "flexmb(1)") for other in others)


def _safe(text):
    """Characters that roff would take for its own."""
    text = re.sub(r"\s+$", "", text).replace("\\", r"\e").replace("-", r"\-")
    return rf"\&{text}" if text[:1] in (".", "'") else text


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, text in pages().items():
        (FOLDER / name).write_text(text, encoding="utf-8")
