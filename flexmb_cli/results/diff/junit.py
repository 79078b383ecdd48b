"""A comparison as a JUnit file, which Jenkins, GitLab and GitHub show as a table of tests."""

from collections.abc import Sequence
from typing import Any
from xml.etree import ElementTree

from ...errors import lines_visible
from .folders import Compared


def junit_bytes(title: str, compared: Sequence[Compared]) -> bytes:
    """Return the file's bytes: a test for every pair of files, failed where they differ or one is missing."""
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
    found: bytes = ElementTree.tostring(top, encoding="utf-8", xml_declaration=True) + b"\n"
    return found


def _add_failure(case: Any, pair: Compared) -> None:
    reported = lines_visible(pair.sentence).rstrip("\n")
    what = "error" if pair.failure is not None else "failure"
    last = reported.splitlines()[0 if pair.failure is not None else -1] if reported else ""
    ElementTree.SubElement(case, what, {"message": last, "type": what}).text = reported
