"""Fixtures that several files of this folder take."""

import io

import pytest

from flexmb_cli.dialects.young.listing import OutTable
from flexmb_cli.results.hdf5.kinematic import kinematic_layout, kinematic_values
from flexmb_cli.results.hdf5.result_file import ResultFile
from tests.results.results import write_result


@pytest.fixture
def table(tmp_path, deck):
    def write(name, rows, layout="safe", failed=False, deck=deck):
        stream = io.StringIO()
        out = OutTable((stream,), deck, layout)
        out.begin()
        out.rows(kinematic_values(rows))
        if failed:
            out.failed()
        path = tmp_path / name
        path.write_text(stream.getvalue())
        return path

    return write


@pytest.fixture
def result(tmp_path, deck, mechanism):
    def write(name, rows, status="complete"):
        file = ResultFile(tmp_path / name, deck, kinematic_layout(mechanism))
        file.rows(kinematic_values(rows))
        file.close(status)
        return tmp_path / name

    return write


@pytest.fixture(params=["OUT", "h5"])
def store(request, table, result):
    """Write rows in one of the two formats."""
    write = table if request.param == "OUT" else result
    return lambda name, rows: write(f"{name}.{request.param}", rows)


@pytest.fixture
def folders(tmp_path):
    """Two folders with equal results `one.h5` and `inner/two.h5`, and a page that is no result."""
    for name in ("old", "new"):
        (tmp_path / name / "inner").mkdir(parents=True)
        write_result(tmp_path / name / "one.h5", 3)
        write_result(tmp_path / name / "inner" / "two.h5", 4)
        (tmp_path / name / "README.md").write_text("# Decks\n")
    return tmp_path / "old", tmp_path / "new"
