"""Numbers of `flexmb run --as-printed` are marked by every command that shows them."""

import re
from pathlib import Path

import pytest
from click.testing import CliRunner
from vtkmodules.vtkIOHDF import vtkHDFReader

from flexmb_cli.cli.export import export
from flexmb_cli.cli.plot import plot
from flexmb_cli.cli.report import report
from flexmb_cli.cli.table import table
from flexmb_cli.results.figures.film import FilmLook, Texts, film_frames
from flexmb_cli.results.quantities.quantities import open_result
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck

DECK = Path(__file__).resolve().parents[2] / "decks/young/IN4-BAR.dat"


@pytest.fixture
def emulated(tmp_path, monkeypatch):
    """Two rows of the four-bar by the program of 1996, in the current folder."""
    monkeypatch.chdir(tmp_path)
    run_deck(str(DECK), RunOptions(as_printed=True, changes=("time.end=0.1",)))


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (table, ["body.3.z"]),
        (export, ["--to", "csv"]),
        (export, ["--to", "mat"]),
        (report, []),
        (plot, ["--title", "T"]),
    ],
)
def test_each_command_marks_the_numbers_of_an_emulation(emulated, command, words):
    if command is plot:
        pytest.importorskip("matplotlib")
        words = [*words, "-o", "p.svg"]
    done = CliRunner().invoke(command, ["OUT4-BAR.h5", *words])
    assert done.exit_code == 0, done.output
    assert "note: numbers of the program YOUNG of 1996 with its known errors" in done.stderr
    if command is report:
        page = Path("OUT4-BAR.html").read_text(encoding="utf-8")
        assert '<p class="failed">numbers of the program YOUNG of 1996' in page
    if command is plot:
        text = Path("p.svg").read_text()
        assert re.search(r"<!-- T\s.*?With the known errors of.*?the program of 1996 ", text, re.S)


def test_paraview_shows_the_mark_of_an_emulation(emulated):
    """VTK's own reader finds the text at the last step, too."""
    assert CliRunner().invoke(export, ["OUT4-BAR.h5", "--to", "vtkhdf"]).exit_code == 0
    reader = vtkHDFReader()
    reader.SetFileName("OUT4-BAR.vtkhdf")
    reader.SetStep(1)
    reader.Update()
    text = reader.GetOutputDataObject(0).GetFieldData().GetAbstractArray("emulation").GetValue(0)
    assert text.startswith("numbers of the program YOUNG of 1996 with its known errors")


def test_the_frames_of_a_film_carry_the_mark(emulated, monkeypatch):
    """Behind the time, at the foot of every frame."""
    pytest.importorskip("matplotlib")
    written = []
    monkeypatch.setattr(Texts, "written", lambda self, picture, time: written.append(time) or picture)
    with open_result("OUT4-BAR.h5") as result:
        list(film_frames(result, FilmLook(width=160, height=120, rate=5)))
    assert written and all(
        text.startswith("t = ") and text.endswith("the program of 1996 (--as-printed)") for text in written
    )
