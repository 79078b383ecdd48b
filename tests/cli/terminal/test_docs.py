"""`flexmb docs` opens the pages of the installation in the browser of the user, or says where they are."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from flexmb_cli.cli import docs as command

pytestmark = pytest.mark.processes


@pytest.fixture
def site(tmp_path, monkeypatch):
    folder = tmp_path / "a site"
    for page in ("index", "reference/index", "reference/young"):
        (folder / page).parent.mkdir(parents=True, exist_ok=True)
        (folder / f"{page}.html").write_text(page)
    monkeypatch.setattr(command, "PLACES", (tmp_path / "none", folder))
    return folder


def docs(*arguments):
    return CliRunner().invoke(command.docs, arguments)


@pytest.mark.parametrize(
    ("page", "file"),
    [
        ("index", "index.html"),
        ("reference/young", "reference/young.html"),
        ("reference/young.md", "reference/young.html"),
        ("reference", "reference/index.html"),
    ],
)
def test_where_prints_the_file_of_a_page(site, page, file):
    assert docs(page, "--where").stdout == f"{site / file}\n"


def test_the_browser_of_the_user_opens_the_page(site, tmp_path):
    """The variable BROWSER of Python's webbrowser, here a program that writes down its argument."""
    browser, opened = tmp_path / "browser", tmp_path / "opened"
    browser.write_text(f'#!/bin/sh\nprintf %s "$1" > "{opened}"\n')
    browser.chmod(0o755)
    code = (
        "from pathlib import Path; from flexmb_cli.cli import docs\n"
        f"docs.PLACES = (Path({str(site)!r}),); docs.docs(['reference/young'])"
    )
    environment = os.environ | {"BROWSER": f"{browser} %s"}
    subprocess.run([sys.executable, "-c", code], env=environment, check=True, timeout=60)
    assert opened.read_text() == (site / "reference/young.html").as_uri()


def test_a_page_that_there_is_not_is_answered_by_those_that_are_like_it(site):
    done = docs("yuong")
    assert done.exit_code == 2 and "there is no page 'yuong'" in done.output
    assert "is one of these meant: reference/young?" in docs("young").output


def test_an_installation_without_pages_says_how_to_get_them(monkeypatch):
    monkeypatch.setattr(command, "PLACES", (Path("/none"),))
    done = docs()
    assert done.exit_code == 2 and "scripts/docs" in done.output and "index.md" in done.output
