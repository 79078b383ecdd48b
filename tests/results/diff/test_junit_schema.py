"""JUnit files against the schema of Jenkins' xUnit plug-in, which pytest validates its own against."""

import os
from pathlib import Path
from xml.etree import ElementTree

import pytest
import xmlschema
from click.testing import CliRunner

from flexmb_cli.cli.diff import diff

SCHEMA = xmlschema.XMLSchema(Path(__file__).with_name("junit-10.xsd"))
# Markup of XML, a control character, bytes that are no UTF-8, two lines, a character beyond 16 bits.
NAMES = [b"<&>\"'.csv", b"]]>.csv", b"\x01\x1b[31m.csv", b"\xff\xfe.csv", b"two\nlines.csv", "𝛼.csv".encode()]


def table(path, number):
    path.write_text(f"time [s],x [m]\n0,{number}\n")


@pytest.fixture
def folders(tmp_path):
    """Two folders with files of hostile names that agree, differ, are missing, or cannot be read."""
    for folder, number in (("a", 1), ("b", 2)):
        for outcome in ("same", "other"):
            (tmp_path / folder / outcome).mkdir(parents=True)
            for name in NAMES:
                table(tmp_path / folder / outcome / os.fsdecode(name), number if outcome == "other" else 1)
    table(tmp_path / "a" / os.fsdecode(b"only\xff<&.csv"), 1)
    for folder in ("a", "b"):
        (tmp_path / folder / "bad.csv").write_bytes(b"\x00<&>\xff")
    return tmp_path / "a", tmp_path / "b"


def test_every_outcome_of_hostile_names_is_valid(folders, tmp_path):
    page = tmp_path / "diff.xml"
    assert CliRunner().invoke(diff, [*map(str, folders), "--junit", str(page)]).exit_code == 2
    SCHEMA.validate(page)
    suite = ElementTree.parse(page).getroot().find("testsuite")
    kinds = [case[0].tag if len(case) else "passed" for case in suite]
    assert {kind: kinds.count(kind) for kind in kinds} == {"failure": 7, "passed": 6, "error": 1}
    assert [suite.get(name) for name in ("tests", "failures", "errors")] == ["14", "7", "1"]
    assert "same/<&>\"'.csv" in {case.get("name") for case in suite}


def test_a_comparison_of_two_files_is_valid(folders, tmp_path):
    page = tmp_path / "diff.xml"
    pair = [str(folder / "other" / os.fsdecode(NAMES[0])) for folder in folders]
    assert CliRunner().invoke(diff, [*pair, "--junit", str(page)]).exit_code == 1
    SCHEMA.validate(page)


def test_the_schema_refuses_what_it_does_not_know():
    """`skipped` was an attribute of `testsuites`, which the plug-in's schema does not allow."""
    assert not SCHEMA.is_valid('<testsuites skipped="0"/>')
    assert not SCHEMA.is_valid("<testsuites><testcase name='a'/></testsuites>")
