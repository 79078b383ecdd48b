"""Collect decks as tests: each deck is run, its results are compared with those in the folder `reference`.

Copy this file beside your decks and make the references by `flexmb run *.dat *.vsdf -o reference`.  A folder
`reference/four-bar/` holds those of `four-bar.vsdf` alone (`flexmb run four-bar.vsdf -o
reference/four-bar`); decks whose results have the same names need that.  A deck without references is
skipped.  Tolerances are read from `tolerances.toml` beside the deck.  `a.dat` beside `a.inp` is CalculiX's.
"""

import importlib.util
import subprocess
import sys

import pytest

# The environment of pytest need not be active: then flexmb is not on the search path.
FLEXMB = (sys.executable, "-m", "flexmb_cli") if importlib.util.find_spec("flexmb_cli") else ("flexmb",)
SUFFIXES = (".dat", ".DAT", ".PAS", ".vsdf")


def pytest_collect_file(file_path, parent):
    """Collect every deck beside a folder of references."""
    of_calculix = file_path.suffix == ".dat" and file_path.with_suffix(".inp").exists()
    if file_path.suffix in SUFFIXES and not of_calculix and (file_path.parent / "reference").is_dir():
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
        own, common = deck.parent / "reference" / deck.stem, deck.parent / "reference"
        # IN4-BAR.dat gives OUT4-BAR.dat and OUT4-BAR.h5, four-bar.vsdf gives four-bar.OUT and four-bar.h5.
        stems = {deck.stem, f"OUT{deck.stem.removeprefix('IN')}"}
        if not own.is_dir() and not any(path.stem in stems for path in common.iterdir() if path.is_file()):
            pytest.skip(f"no references of {deck.name} in {common}")
        results = self.config._tmp_path_factory.mktemp(deck.stem)
        self.call("run", "--quiet", deck, "-o", results)
        tolerances = deck.parent / "tolerances.toml"
        options = ("--tolerances", tolerances) if tolerances.exists() else ()
        if own.is_dir():
            self.call("diff", own, results, *options)
            return
        kept = [path.name for path in sorted(results.iterdir()) if (common / path.name).exists()]
        assert kept, f"none of the results of {deck.name} has a reference in {common}"
        for name in kept:
            self.call("diff", common / name, results / name, *options)

    def call(self, *words):
        """Run flexmb; a failure is the text that it prints."""
        done = subprocess.run([*FLEXMB, *map(str, words)], capture_output=True, text=True)
        if done.returncode:
            pytest.fail(f"{done.stdout}{done.stderr}", pytrace=False)

    def reportinfo(self):
        """Name the deck."""
        return self.path, None, f"{self.path.name}: {self.name}"
