"""`flexmb examples`: the supplied decks, listed or copied."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from ..dialects.recognise import every_dialect
from ..results.files.replaced_file import make_folder, write_together

PACKAGE = Path(__file__).resolve().parents[1]
# In a wheel the decks lie in the package, in a checkout beside it.
PLACES = (PACKAGE / "decks", PACKAGE.parent / "decks")
SUFFIXES = {Path(each.new_name).suffix: each.title for each in reversed([*every_dialect()])} | {
    ".toml": "study"
}


def example_names(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[str]:
    """Return the names of the supplied decks."""
    return [name for name in supplied() if name.startswith(incomplete)]


@click.command()
@click.argument("names", nargs=-1, metavar="[NAME...]", shell_complete=example_names)
@click.option(
    "-o", "--output-dir", type=click.Path(path_type=Path), default=".", help="Folder of the copies."
)
@click.option(
    "--all", "everything", is_flag=True, help="Copy all, in the folders that the documentation names."
)
@click.option("--force", is_flag=True, help="Replace files that are there already.")
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
def examples(names: tuple[str, ...], output_dir: Path, everything: bool, force: bool, quiet: bool) -> None:
    """List the supplied decks, or copy those named, with the files they need.

    \b
    Example:
        flexmb examples
        flexmb examples IN4-BAR pendulum_ccx
        flexmb examples --all
    """
    if everything:
        if names:
            raise click.UsageError("--all copies every example: leave out the names")
        copied = _copy_all(output_dir, force)
        if not quiet:
            click.echo(f"{copied} examples → {output_dir / 'decks'}")
        return
    decks = supplied()
    if not names:
        _list(decks)
        return
    for name in names:
        if name not in decks:
            raise click.UsageError(f"there is no example {name!r}; {_similar(name, decks)}")
    for name in names:
        copied = _copy(decks[name], output_dir, force)
        if not quiet:
            click.echo(f"{name} → {', '.join(map(str, copied))}")


def supplied() -> dict[str, Path]:
    """Return the supplied decks and studies by name.

    Decks of two dialects with one name are distinguished by their suffix: `pendulum.DAT`, `pendulum.vsdf`.
    """
    folder = _folder()
    files = sorted(path for path in folder.rglob("*") if path.suffix in SUFFIXES and path.is_file())
    stems = [path.stem for path in files]
    return {path.stem if stems.count(path.stem) == 1 else path.name: path for path in files}


def _folder() -> Any:
    folder = next((place for place in PLACES if place.is_dir()), None)
    if folder is None:
        raise click.UsageError("this installation has no examples; they are in the repository's folder decks")
    return folder


def _copy_all(output_dir: Any, force: bool) -> Any:
    """Copy the folder of the decks as it is; return how many examples it holds."""
    target = output_dir / "decks"
    _refuse_taken([target], force)
    files = sorted(path for path in _folder().rglob("*") if path.is_file())
    _write({target / path.relative_to(_folder()): path.read_bytes() for path in files})
    return len(supplied())


def _write(contents: dict[Path, bytes]) -> None:
    """Write all files or none: a full disk leaves what was there."""

    for folder in {path.parent for path in contents}:
        make_folder(folder)
    write_together(contents)


def _similar(name: str, decks: dict[str, Path]) -> str:
    """Return the examples whose names are like `name`, or how to list them."""
    from difflib import get_close_matches

    by_letters = {known.lower(): known for known in decks}
    close = [known for known in by_letters if known.startswith(name.lower())][:5]
    close = close or get_close_matches(name.lower(), by_letters)
    names = ", ".join(by_letters[known] for known in close)
    return f"is one of these meant: {names}?" if names else "`flexmb examples` lists them"


def _list(decks: dict[str, Path]) -> Any:
    described: dict[Any, Any] = {}
    for folder in {path.parent for path in decks.values()}:
        described |= dict(_descriptions(folder))
    width = max(map(len, decks))
    for name, path in sorted(decks.items(), key=lambda item: (list(SUFFIXES).index(item[1].suffix), item[0])):
        reported = described.get((path.suffix, path.stem), "")
        click.echo(f"{name:{width}}  {SUFFIXES[path.suffix]:5}  {reported}".rstrip())


def _descriptions(folder: Path) -> Iterator[tuple[tuple[str, str], str]]:
    """Yield what the page beside the decks says of each: ((suffix, name), text)."""
    page = next((p / "README.md" for p in (folder, folder.parent) if (p / "README.md").exists()), None)
    suffixes = {path.suffix for path in folder.iterdir() if path.suffix in SUFFIXES}
    for line in page.read_text(encoding="utf-8").splitlines() if page else ():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) > 1 and cells[0].startswith("`"):
            for name in _whole_names(re.findall(r"`([\w-]+)`", cells[0])):
                yield from (((suffix, name), cells[1]) for suffix in suffixes)


def _whole_names(names: tuple[str, ...] | list[Any]) -> Iterator[Any]:
    """Complete names such as `_n5` after `shaft_beam_n2`."""
    for name in names:
        yield names[0].rpartition("_")[0] + name if name.startswith("_") else name


def _copy(deck: Path, folder: Path, force: bool) -> list[Path]:
    """Copy a deck and the files it names into `folder`; return the copies, the deck first."""
    text = deck.read_bytes().decode("utf-8")
    sources = {}
    for word in text.replace('"', " ").split():
        named = deck.parent / word
        if "/" in word and named.is_file():
            # What lies beside the folder of the decks is put beside the copy.
            sources[named] = Path(named.name) if word.startswith("..") else Path(word)
            text = text.replace(word, sources[named].as_posix())
    targets = {source: folder / to for source, to in sources.items()}
    _refuse_taken([folder / deck.name, *targets.values()], force)
    contents = {folder / deck.name: text.encode()}
    _write(contents | {target: source.read_bytes() for source, target in targets.items()})
    return [folder / deck.name, *targets.values()]


def _refuse_taken(targets: Any, force: bool) -> None:
    """Refuse targets that exist; a copy would also be written where a link to nothing leads."""
    taken = [str(target) for target in targets if target.exists() or target.is_symlink()]
    if taken and not force:
        raise click.UsageError(f"{taken[0]} is there already; --force replaces it")
