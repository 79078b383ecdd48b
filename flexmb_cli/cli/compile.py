"""`flexmb compile`: all kernels compiled before the first run, for images of containers."""

from typing import Any

import click

from .terminal.screen import notify


@click.command("compile")
@click.option("--list", "listing", is_flag=True, help="List the user's cache of kernels, and its size.")
@click.option("--clear", is_flag=True, help="Delete the user's cache of kernels, of all versions.")
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
def compile_(listing: bool, clear: Any, quiet: bool) -> None:
    """Compile all kernels now, so that no first run waits for them.

    A wheel built with FLEXMB_REQUIRE_AOT=1 contains them and needs no compilation; other installations
    compile what a run needs, once per version.

    \b
    Example:
        flexmb compile
    """
    if listing and clear:
        raise click.UsageError("--list and --clear exclude each other: give one")
    from ..solvers.compilation import (
        clear_compiled,
        has_library,
        list_compiled,
        missing_units,
        nothing_to_compile,
        provide_unit,
        refused_places,
    )

    if listing:
        _show(list_compiled())
    elif clear:
        count, stay = clear_compiled()
        if not quiet:
            notify(f"flexmb: {count} file{'' if count == 1 else 's'} of compiled kernels deleted")
        for path in stay:
            notify(f"flexmb: warning: {path} cannot be deleted")
    elif nothing_to_compile():
        raise click.UsageError("NUMBA_DISABLE_JIT is set: kernels are interpreted, and none can be compiled")
    elif has_library():
        notify("flexmb: nothing to do: this installation has compiled kernels")
    else:
        _provide(list(missing_units()), provide_unit, quiet)
    for sentence in refused_places():
        notify(f"flexmb: warning: {sentence}")


def _provide(units: list[tuple[str, bool]], provide_unit: Any, quiet: bool) -> None:
    import sys

    if not quiet and not units:
        notify("flexmb: all kernels are compiled")
    shown = not quiet and sys.stderr.isatty()
    with click.progressbar(units, label="compiling", file=sys.stderr, hidden=not shown) as bar:
        for unit, elsewhere in bar:
            if not quiet and not shown:
                notify(f"flexmb: {'copying' if elsewhere else 'compiling'} {unit}")
            provide_unit(unit)


def _show(files: Any) -> None:
    """A line for each file, and their sum."""
    total = 0
    for path, size, why in files:
        click.echo(f"{size / 1024:8.0f} kB  {path}{why and '  ' + why}")
        total += size
    click.echo(f"{total / 1024:8.0f} kB  in all")
