"""`flexmb diff`: compare results."""

import json
import os
import sys
from collections.abc import Sequence
from typing import Any

import click

from ..deck.listing import TableError
from ..errors import Fault, compiler_style, lines_visible, visible
from ..results.diff.compare import accept, accept_pair, compare, is_missing
from ..results.diff.folders import Compared, Pair, Summary, are_same, is_many, matched
from ..results.diff.tolerance_file import FileTolerances, read_tolerances
from ..results.diff.tolerances import Tolerances, parse_kinds
from ..results.files.replaced_file import write_whole
from ..run.compare_many import compare_many
from .options.output_file import AS_JSON, STANDARD_OUTPUT, Finite, WrittenPlace, files, refuse_inputs
from .terminal.notices import faults_in_json
from .terminal.screen import WrongCall, notify, say, show


@click.command()
@click.argument("a", shell_complete=files)
@click.argument("b", shell_complete=files)
@click.option("--last-digit", type=click.IntRange(0), default=0, metavar="N",
              help="Allow N units of the last printed digit.")  # fmt: skip
@click.option("--atol", type=Finite(0), help="Allow this distance.")
@click.option("--rtol", type=Finite(0), help="Allow this part of the larger value.")
@click.option("--tol", "kinds", multiple=True, metavar="TYPE=ATOL[,RTOL]",
              help="Tolerance of a type of column (omega=1e-3); inf leaves it out.")  # fmt: skip
@click.option("--same-attitude", is_flag=True, help="Euler parameters p and -p count as equal.")
@click.option("--list", "listed", type=click.IntRange(0), default=0, metavar="N",
              help="List N of the numbers that differ, with their lines in A.")  # fmt: skip
@click.option("--explain", is_flag=True,
              help="Mark differences that are known errors of the historic programs.")  # fmt: skip
@click.option("--deck", metavar="DECK",
              help="With --explain: the YOUNG deck of both, run with the errors of 1996.")  # fmt: skip
@click.option(
    "--words", is_flag=True, help="Differences in words count, too: titles, names, notes, settings."
)
@click.option("--tolerances", "tolerance_file", metavar="FILE.toml", shell_complete=files,
              help="Tolerances per file, per type of column and per quantity.")  # fmt: skip
@click.option("--update", is_flag=True, help="If A and B differ, replace A by a copy of B.")
@click.option(
    "--junit", type=WrittenPlace(), metavar="FILE", help="Write a JUnit file, a test for each file."
)
@click.option("-j", "--jobs", type=click.IntRange(1), default=1, show_default=True,
              help="Files of folders compared at once.")  # fmt: skip
@AS_JSON
@click.option("-q", "--quiet", is_flag=True, help="Print nothing; only the exit code reports.")
def diff(
    a: str, b: str, update: bool, junit: str | None, jobs: int, as_json: bool, quiet: bool, **options: Any
) -> None:
    """Compare results number by number: OUT tables, DAFMS echoes or series, HDF5, CSV or MATLAB files.

    A is the reference.  A value differs when it exceeds all tolerances given; by default every printed
    digit counts.  Differences in words are reported, and count with --words only.  A and B may be folders
    or quoted patterns: files of one name are compared, and one that is missing counts as a difference.

    \b
    Example:
        flexmb diff reference/OUT4-BAR.dat OUT4-BAR.dat --last-digit 1
        flexmb diff reference results --junit diff.xml
    """

    if options["deck"] and not options["explain"]:
        raise WrongCall("--deck goes with --explain", id="CLI-018")
    if update and "-" in (a, b):
        raise WrongCall("--update copies files; standard input is not a file", id="CLI-019")
    many = is_many(a), is_many(b)
    _refuse_unlike(a, b, many)
    tolerances = _tolerances(options)
    notes = []
    summary = matched(a, b) if all(many) else Summary(a, b, [Pair(a, a, b)])
    if are_same(summary.pairs):
        message = f"{a} and {b} are the same, so that nothing can differ"
        if all(many):
            raise WrongCall(f"{message}: give the reference and the new results", id="CLI-020")
        notes = [Fault("note", message, id="DIFF-033").as_dict()]
        if not quiet:
            notify(f"note: {message}")
    if all(many):
        _compare_folders(summary, tolerances, update, as_json, jobs, options)
    else:
        summary.compared = [_compare_files(a, b, tolerances, update, as_json, options)]
    tolerances.refuse_unused()
    if junit:
        _write_junit(junit, summary)
    if all(many):
        _print_summary(summary, as_json, quiet)
    else:
        _print_report(summary.compared[0], update, as_json, quiet, notes)
    sys.exit(summary.exit_code)


def _refuse_unlike(a: str, b: str, many: tuple[bool, bool]) -> None:
    """Raise UsageError where one is a folder or a pattern, and the other a file."""
    if any(many) and not all(many):
        single, other = (a, b) if many[1] else (b, a)
        if single != "-" and not os.path.exists(single):
            raise WrongCall(f"{single}: no such file or folder", id="CLI-021")
        raise WrongCall(
            f"{other} is a folder or a pattern, {single} is not: give two files, two folders or two patterns",
            id="CLI-022",
        )


def _tolerances(options: dict[Any, Any]) -> Any:
    """Take what counts as a difference out of the options."""

    kinds = parse_kinds(options.pop("kinds"))
    general = Tolerances(options.pop("atol"), options.pop("rtol"), options.pop("last_digit"), kinds)
    path = options.pop("tolerance_file")
    return read_tolerances(path, general) if path else FileTolerances(general=general)


def _compare_files(a: Any, b: Any, tolerances: Any, update: bool, as_json: bool, options: Any) -> Compared:

    new = update and is_missing(a)
    try:
        with faults_in_json(as_json, {"a": a, "b": b, "updated": False}, b):
            # A result that can be compared with itself can be read.
            report = compare(b if new else a, b, tolerances.of_file(b), **options)
            updated = update and (new or not report.equal)
            if updated:
                accept(a, b)
    except TableError as failure:
        say(compiler_style(failure.name, failure.faults, failure.lines))
        sys.exit(failure.exit_code)
    return Compared(Pair(a, a, b), report, updated=updated, new=new)


def _compare_folders(
    summary: Summary,
    tolerances: FileTolerances,
    update: bool,
    as_json: bool,
    jobs: int,
    options: dict[str, Any],
) -> None:

    with faults_in_json(as_json, {"a": summary.a, "b": summary.b}, summary.b):
        compare_many(summary, tolerances, options, jobs)
        if update:
            for compared in summary.compared:
                accept_pair(compared, summary.a)


def _write_junit(path: str, summary: Summary) -> None:

    content = junit_bytes(f"flexmb diff {summary.a} {summary.b}", summary.compared)
    if path == STANDARD_OUTPUT:
        click.echo(content, nl=False)
        return
    refuse_inputs(path, [name for x in summary.compared for name in (x.pair.a, x.pair.b) if name], "--junit")
    write_whole(path, content)


def _print_report(compared: Any, update: bool, as_json: bool, quiet: bool, notes: list[Any]) -> None:
    a, b, updated = compared.pair.a, compared.pair.b, compared.updated
    if as_json:
        click.echo(json.dumps(compared.report.as_dict() | {"a": a, "updated": updated, "faults": notes}))
    elif not quiet:
        show("" if compared.new else compared.report.text())
        if update:
            done = f"updated from {visible(b)}" if updated else "left as it is"
            show(f"{visible(a)}: {'new reference, ' if compared.new else ''}{done}\n")


def _print_summary(summary: Summary, as_json: bool, quiet: bool) -> None:
    failed = [compared for compared in summary.compared if compared.failure is not None]
    show("".join(compared.sentence for compared in failed), err=True)
    if as_json:
        click.echo(json.dumps(summary.as_dict()))
    elif not summary.compared:
        show(summary.verdict, err=True)
    elif not quiet:
        differing = [x for x in summary.compared if x.failure is None and not x.equal]
        show("".join(compared.sentence for compared in differing) + summary.verdict)


def junit_bytes(title: str, compared: Sequence[Compared]) -> bytes:
    """Return the file's bytes: a test for every pair of files, failed where they differ or one is missing."""
    from xml.etree import ElementTree

    failed = sum(pair.failure is None and not pair.equal for pair in compared)
    errors = sum(pair.failure is not None for pair in compared)
    counts = {"tests": str(len(compared)), "failures": str(failed), "errors": str(errors)}
    # The schema of Jenkins' xUnit plug-in allows no `skipped` here.
    top = ElementTree.Element("testsuites", counts)
    suite = ElementTree.SubElement(top, "testsuite", {"name": lines_visible(title), **counts, "skipped": "0"})
    for pair in compared:
        case = ElementTree.SubElement(
            suite, "testcase", {"name": lines_visible(pair.pair.name), "classname": "flexmb.diff"}
        )
        if pair.failure is not None or not pair.equal:
            _add_failure(case, pair)
        elif pair.report is not None and pair.report.unreadable:
            ElementTree.SubElement(case, "system-out").text = lines_visible(pair.sentence).rstrip("\n")
    ElementTree.indent(top)
    return ElementTree.tostring(top, encoding="utf-8", xml_declaration=True) + b"\n"


def _add_failure(case: Any, pair: Compared) -> None:
    from xml.etree import ElementTree

    reported = lines_visible(pair.sentence).rstrip("\n")
    what = "error" if pair.failure is not None else "failure"
    last = reported.splitlines()[0 if pair.failure is not None else -1] if reported else ""
    ElementTree.SubElement(case, what, {"message": last, "type": what}).text = reported
