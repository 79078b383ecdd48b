"""`flexmb diff --update`, and results that are too large or no files."""

import json
import subprocess
import sys
import tracemalloc
from pathlib import Path

import h5py
import pytest

from flexmb_cli.deck import listing
from flexmb_cli.deck.listing import TableError
from flexmb_cli.results.diff import hdf5
from flexmb_cli.results.diff.compare import accept, compare
from flexmb_cli.results.diff.listings import read_listing
from tests.results.diff.test_diff import TIMES, shifted
from tests.results.results import write_result


def flexmb(*arguments, cwd):
    return subprocess.run(
        [sys.executable, "-m", "flexmb_cli", "diff", *map(str, arguments)],
        cwd=cwd, capture_output=True, text=True, encoding="utf-8", timeout=60,
    )  # fmt: skip


def test_update_takes_the_second_file_as_reference(table, rows, tmp_path):
    base = rows(TIMES)
    a, b = table("a", base), table("b", shifted(base, "velocity", 0.25, item=0))
    a.chmod(0o640)
    done = flexmb("a", "b", "--update", cwd=tmp_path)
    assert done.returncode == 0
    verdict = "a, b: 1 of 519 numbers differ, 0 missing entries"
    assert done.stdout.splitlines()[-2:] == [verdict, "a: updated from b"]
    assert a.read_bytes() == b.read_bytes()
    assert a.stat().st_mode & 0o777 == 0o640
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "b"]


def test_update_leaves_a_reference_that_agrees(table, rows, tmp_path):
    base = rows(TIMES)
    a, _ = table("a", base), table("b", shifted(base, "velocity", 0.001, item=0))
    before = a.read_bytes()
    done = flexmb("a", "b", "--update", "--last-digit", "1", cwd=tmp_path)
    assert (done.returncode, done.stdout.splitlines()[-1]) == (0, "a: left as it is")
    assert a.read_bytes() == before


def test_update_makes_a_reference_that_is_not_there(store, rows, tmp_path):
    b = store("b", rows(TIMES))
    reported = json.loads(flexmb("new", b, "--update", "--json", cwd=tmp_path).stdout)
    assert reported["updated"] is True
    assert (tmp_path / "new").read_bytes() == b.read_bytes()


def test_update_refuses_what_is_no_result_and_what_cannot_be_written(table, rows, tmp_path):
    a = table("a", rows(TIMES))
    before = a.read_bytes()
    (tmp_path / "letter").write_text("Dear Sir,\n")
    for arguments, message in (
        (["a", "letter"], "no OUT table is found in it"),
        (["new", "letter"], "no OUT table is found in it"),
        (["a", "none"], "no such file"),
        (["none/new", "a"], "its folder does not exist"),
        (["a", "-"], "standard input"),
    ):
        done = flexmb(*arguments, "--update", cwd=tmp_path)
        assert done.returncode == 2
        assert message in done.stderr
    assert a.read_bytes() == before
    assert not (tmp_path / "new").exists()


def test_comparing_results_takes_no_more_memory_than_a_part_of_them(tmp_path, monkeypatch):
    monkeypatch.setattr(hdf5, "NUMBERS_AT_ONCE", 2**16)

    def peak(rows):
        path = write_result(tmp_path / f"{rows}.h5", rows)
        tracemalloc.start()
        assert compare(path, path, same_attitude=True).equal
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    # Twelve Euler parameters a row are the largest dataset: a part is 5461 rows of them.
    assert peak(44000) < 1.2 * peak(22000)


def test_update_follows_no_link_of_a_result_to_another_file(result, rows):
    """A reference that took its rows from elsewhere would change without being touched."""
    a, b = result("a.h5", rows(TIMES)), result("b.h5", rows(TIMES))
    with h5py.File(b, "r+") as file:
        del file["time"]
        file["time"] = h5py.ExternalLink(a.name, "/time")
    before = a.read_bytes()
    with pytest.raises(TableError, match="time is a link to elsewhere") as caught:
        accept(a, b)
    assert caught.value.name == str(b)
    assert a.read_bytes() == before


def test_a_file_that_is_too_large_is_refused_before_it_is_read(tmp_path, monkeypatch):
    """One of 3 GB took half a gigabyte of memory first."""
    read = []
    monkeypatch.setattr(listing, "first_bytes", lambda file, most: read.append(file) or file.read(most))
    with (tmp_path / "OUT.dat").open("wb") as file:
        file.truncate(3 * 2**30)
    with pytest.raises(TableError, match="larger than 512 MB: compare the HDF5 results"):
        read_listing(str(tmp_path / "OUT.dat"))
    assert not read


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="needs a device that never ends")
def test_a_file_without_end_is_refused_before_memory_is_full(monkeypatch):
    monkeypatch.setattr(listing, "LARGEST_LISTING", 2**20)
    with pytest.raises(TableError, match="larger than 1 MB: compare the HDF5 results"):
        read_listing("/dev/zero")
