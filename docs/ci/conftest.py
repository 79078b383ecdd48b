"""Collect decks as tests: a deck with a folder of references is run, and its results are compared.

Copy this file beside your decks.  The references of `four-bar.vsdf` are the files in `reference/four-bar/`,
made by `flexmb run four-bar.vsdf -o reference/four-bar`.  Tolerances are read from `tolerances.toml` there.
"""

import subprocess

import pytest

SUFFIXES = (".dat", ".DAT", ".PAS", ".vsdf")


def pytest_collect_file(file_path, parent):
    """Collect every deck that has references."""
    reference = file_path.parent / "reference" / file_path.stem
    if file_path.suffix in SUFFIXES and reference.is_dir():
        return DeckFile.from_parent(parent, path=file_path)
    return None


class DeckFile(pytest.File):
    """A deck."""

    def collect(self):
        """Yield its one test."""
        yield DeckTest.from_parent(self, name="same results as the reference")


class DeckTest(pytest.Item):
    """Runs the deck and compares all results."""

    def runtest(self):
        """Fail with what flexmb prints."""
        deck = self.path
        results = self.config._tmp_path_factory.mktemp(deck.stem)
        self.call("run", "--quiet", deck, "-o", results)
        tolerances = deck.parent / "tolerances.toml"
        options = ("--tolerances", tolerances) if tolerances.exists() else ()
        self.call("diff", deck.parent / "reference" / deck.stem, results, *options)

    def call(self, *words):
        """Run flexmb; a failure is the text that it prints."""
        done = subprocess.run(["flexmb", *map(str, words)], capture_output=True, text=True)
        if done.returncode:
            pytest.fail(f"{done.stdout}{done.stderr}", pytrace=False)

    def reportinfo(self):
        """Name the deck."""
        return self.path, None, f"{self.path.name}: {self.name}"
