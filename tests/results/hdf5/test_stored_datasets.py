"""Datasets are open only while they are looked at: 40,000 small ones, in a file of 12 MB, took 640 MB."""

import h5py
import pytest

from flexmb_cli.results.diff import hdf5 as diff_hdf5
from flexmb_cli.results.diff.compare import compare
from flexmb_cli.results.diff.tolerances import Tolerances
from flexmb_cli.results.hdf5.stored_result import StoredDatasets
from flexmb_cli.results.quantities import quantity_names
from flexmb_cli.results.quantities.quantity_names import families
from tests.results.results import write_result

# One that is looked at, the time, a scale, and one more that Python has not yet closed.
MOST_OPEN = 4


def open_datasets(file):
    return h5py.h5f.get_obj_count(file.id, h5py.h5f.OBJ_DATASET)


@pytest.fixture
def result(tmp_path):
    return write_result(tmp_path / "r.h5", 5)


def watch(monkeypatch, module, name, dataset_of):
    """Return a list to which each call of a function adds how many datasets of its file are open."""
    counts, watched = [], getattr(module, name)

    def counted(*given):
        counts.append(open_datasets(dataset_of(given).file))
        return watched(*given)

    monkeypatch.setattr(module, name, counted)
    return counts


def test_the_search_for_quantities_keeps_no_dataset_open(result, monkeypatch):
    counts = watch(monkeypatch, quantity_names, "_runs_along", lambda given: given[2])
    with h5py.File(result, "r") as file:
        assert len(families(file)) > 2 * MOST_OPEN
    assert max(counts) <= MOST_OPEN


def test_a_comparison_opens_one_pair_of_datasets_at_a_time(result, tmp_path, monkeypatch):
    other = write_result(tmp_path / "s.h5", 5)
    counts = watch(monkeypatch, diff_hdf5, "_compare_dataset", lambda given: given[2][0])
    compare(result, other, Tolerances())
    assert len(counts) > 2 * MOST_OPEN and max(counts) <= MOST_OPEN


def test_datasets_are_found_by_their_paths_without_groups(result):
    with h5py.File(result, "r+") as file:
        found = StoredDatasets(file)
        assert all(isinstance(item, h5py.Dataset) for item in found.values())
        assert "time" in found and "body" not in found and len(found) == len(list(found))
        found.leave_out("time")
        with pytest.raises(KeyError):
            found["time"]
