"""What stands in the place of a result is replaced where flexmb made it; a file of the user needs `--force`.

The rule is that of the page on exit codes (docs/reference/exit-codes.md): results of any age, cut ones and
empty files are flexmb's.
"""

import os
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.results.files.file_names import is_own, refuse_foreign

TOP = Path(__file__).resolve().parents[2]
DECKS = TOP / "decks"
FOUR_BAR, PENDULUM = DECKS / "young/IN1-1-1.dat", DECKS / "dafms/spatial_rigid.DAT"
LISTINGS = sorted((TOP / "tests/published/dafms").glob("*.OUT"))
# As the program of 1996 printed it (YOUNG dissertation, appendix B), with the line ends of DOS.
PRINTED = b"ENTER NUMBER OF\r\nbody : NBODY\r\ndriver: NDRIVE\r\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(FOUR_BAR, "INX.dat")
    shutil.copy(PENDULUM, "q.DAT")
    return tmp_path


def flexmb(*words):
    done = CliRunner().invoke(cli, [*map(str, words)], standalone_mode=False)
    code = getattr(done.exception, "exit_code", done.exit_code)
    return code, f"{done.stderr}{done.exception or ''}"


@pytest.mark.parametrize(
    ("words", "place"),
    [
        (["run", "INX.dat"], "OUTX.dat"),
        (["run", "INX.dat"], "OUTX.h5"),
        (["run", "q.DAT"], "q.OUT"),
        (["run", "q.DAT"], "q.T2"),
        (["run", "q.DAT", "-j", "1"], "q.T3"),
        (["convert", DECKS / "dafms/spatial_rigid.DAT", "--to", "vsdf"], "spatial_rigid.vsdf"),
        (["convert", DECKS / "dafms/spatial_rigid.DAT", "--to", "mjcf"], "spatial_rigid.xml"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_file_of_the_user_is_replaced_by_force_alone(folder, words, place):
    before = (DECKS / "young/IN4-BAR.dat").read_bytes() if place != "q.T3" else b"1.0 2.0\nmy notes\n"
    Path(place).write_bytes(before)
    code, reported = flexmb(*words)
    assert (code, Path(place).read_bytes()) == (2, before)
    assert f"{place}: a file stands there that flexmb did not make; --force replaces it" in reported
    assert flexmb(*words, "--force")[0] == 0
    assert Path(place).read_bytes() != before
    made = Path(place).read_bytes()
    assert (flexmb(*words)[0], Path(place).read_bytes()) == (0, made)


def test_places_that_the_user_names_are_written_as_ever(folder):
    Path("table").write_text("my notes")
    Path("h5").write_text("my notes")
    assert flexmb("run", "INX.dat", "--out", "table", "--h5", "h5")[0] == 0
    assert "my notes" not in Path("table").read_text()
    assert flexmb("run", "INX.dat", "--out", os.devnull, "--no-h5")[0] == 0


def test_nothing_is_solved_where_one_place_is_taken(folder, monkeypatch):
    """Refused before anything is solved; the other deck of the call is run all the same."""
    Path("OUTX.h5").write_text("my notes")
    assert flexmb("run", "INX.dat", "q.DAT")[0] == 2
    assert sorted(path.name for path in folder.iterdir() if path.suffix != ".DAT") == [
        "INX.dat", "OUTX.h5", "q.OUT", "q.T2", "q.T3", "q.h5",
    ]  # fmt: skip


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """The files of runs of all dialects."""
    folder = tmp_path_factory.mktemp("results")
    decks = [FOUR_BAR, PENDULUM, DECKS / "vsdf/freeflying.vsdf"]
    assert flexmb("run", "-q", *decks, "-o", folder)[0] == 0
    assert flexmb("run", "-q", FOUR_BAR, "--as-printed", "--no-h5", "--out", folder / "PRINTED.OUT")[0] == 0
    return sorted(folder.iterdir())


def test_what_a_run_leaves_is_its_own_wherever_it_is_cut(results, tmp_path):
    """Lengths about powers of two, at which disks and buffers cut."""
    assert {path.suffix for path in results} == {".OUT", ".T2", ".T3", ".dat", ".h5"}
    for path in results:
        content = path.read_bytes()
        for length in {0, 1, 2, 5, 17, *(2**k + d for k in range(5, 13) for d in (-1, 0, 1)), len(content)}:
            cut = tmp_path / path.name
            cut.write_bytes(content[:length])
            assert is_own(str(cut)), (path.name, length)


@pytest.mark.parametrize("path", [*LISTINGS, *sorted((TOP / "tests/results/hdf5/earlier").glob("*.h5"))],
                         ids=lambda path: path.name)  # fmt: skip
def test_results_of_earlier_versions_are_its_own(path):
    assert is_own(str(path))


def test_a_listing_of_the_program_of_1996_and_zeros_are_its_own(tmp_path):
    for content in (PRINTED, bytes(512), b"", b"\n"):
        (tmp_path / "x.OUT").write_bytes(content)
        assert is_own(str(tmp_path / "x.OUT"))


@pytest.mark.parametrize("deck", sorted(path for path in DECKS.rglob("*") if path.is_file()),
                         ids=lambda path: path.name)  # fmt: skip
def test_no_supplied_deck_is_taken_for_a_result(deck, tmp_path):
    """Neither under its name nor under that of a series."""
    for name in (deck.name, f"{deck.stem}.T2"):
        shutil.copy(deck, tmp_path / name)
        assert not is_own(str(tmp_path / name))


def test_data_of_others_are_not_its_own(tmp_path):
    with h5py.File(tmp_path / "x.h5", "w") as file:
        file.attrs["Conventions"] = "CF-1.8"
        file["measured"] = np.arange(1000.0)
    (tmp_path / "x.T2").write_text("0.0 1.5\n0.1 1.6\n")
    (tmp_path / "x.T3").write_text("   0.0000000 note\n")
    (tmp_path / "y.T2").write_text("42")
    (tmp_path / "y.h5").write_bytes(bytes(2**17) + b"samples")
    (tmp_path / "x.csv").write_text("time [s],force [N]\n0,1\n")
    (tmp_path / "x.png").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(range(100)))
    (tmp_path / "x.html").write_text('<!DOCTYPE html>\n<html lang="en">\n<head>\n')
    for path in tmp_path.iterdir():
        assert not is_own(str(path)), path.name


@pytest.mark.parametrize("form", ["csv", "mat", pytest.param("vtkhdf", marks=pytest.mark.campaign)])
def test_exports_replace_exports_and_nothing_else(results, tmp_path, monkeypatch, form):
    monkeypatch.chdir(tmp_path)
    result = next(path for path in results if path.name == "OUT1-1-1.h5")
    words = ["export", result, "--to", form, "-q"]
    for _ in range(2):
        assert flexmb(*words)[0] == 0
    place = Path(f"OUT1-1-1.{form}")
    place.write_text("time [s],measured [N]\n0,1\n")
    assert flexmb(*words)[0] == 2 and place.read_text().endswith("0,1\n")
    assert flexmb(*words, "--force")[0] == 0 and place.stat().st_size > 100


PAGES = {"report": "spatial_rigid.html", "plot": "spatial_rigid.png"}


@pytest.mark.parametrize("command", PAGES)
def test_pages_and_pictures_replace_no_files_of_others(results, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    Path(PAGES[command]).write_text("my page")
    result = next(path for path in results if path.name == "spatial_rigid.h5")
    assert flexmb(command, result)[0] == 2 and Path(PAGES[command]).read_text() == "my page"


@pytest.mark.campaign
@pytest.mark.parametrize("command", PAGES)
def test_pages_and_pictures_replace_their_like(results, tmp_path, monkeypatch, command):
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    result = next(path for path in results if path.name == "spatial_rigid.h5")
    for _ in range(2):
        assert flexmb(command, result, "-q")[0] == 0
    assert Path(PAGES[command]).stat().st_size > 1000


def test_a_study_replaces_no_data_of_others(folder):
    text = 'deck = "INX.dat"\n[parameters]\n"body.1.x" = [0.0]\n[results]\nlast = "last body.1.x"\n'
    Path("s.toml").write_text(text)
    with h5py.File("s.h5", "w") as file:
        file["measured"] = np.arange(10.0)
    code, reported = flexmb("sweep", "s.toml")
    assert code == 2 and "--force replaces it" in reported and not Path("s.h5.parts").exists()


@pytest.mark.parametrize("name", ["a" * 300 + ".DAT", "no-folder/r.DAT"])
def test_a_deck_that_cannot_be_looked_at_stops_no_other(folder, name):
    """NAME_MAX of Linux is 255 bytes: stat fails by ENAMETOOLONG, as by EACCES in a folder of others."""
    code, reported = flexmb("run", name, "q.DAT", "-q")
    assert code == 2 and name[:100] in reported and Path("q.OUT").exists()


def test_an_edited_conversion_is_renamed_before_the_next(folder):
    """Nothing is lost: a converted model is a beginning that users edit."""
    words = ["convert", "q.DAT", "--to", "vsdf"]
    assert flexmb(*words)[0] == 0
    made = Path("q.vsdf").read_bytes()
    assert flexmb(*words)[0] == 0 and not Path("q.vsdf.stale").exists()
    Path("q.vsdf").write_bytes(made + b"* my notes\n")
    assert "of an earlier call, now q.vsdf.stale" in flexmb(*words)[1]
    assert (Path("q.vsdf").read_bytes(), Path("q.vsdf.stale").read_bytes()) == (made, made + b"* my notes\n")


def test_a_link_is_judged_by_what_it_leads_to(folder):
    Path("notes").write_text("my notes")
    os.symlink("notes", "OUTX.dat")
    with pytest.raises(Exception, match=r"OUTX\.dat: a file stands there that flexmb did not make"):
        refuse_foreign(["OUTX.dat"])
