"""`check`, `diff` and `table` answer without numba and scipy, whatever they are given."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

from flexmb_cli.study.table import Column, TableHead, write_table
from tests.house.test_house import OF_SPARSE_MATRICES
from tests.results.results import write_result
from tests.solvers.kinematics.young_linkages import four_bar, slider_crank

pytestmark = pytest.mark.processes

TESTS = Path(__file__).resolve().parents[1]
DECKS = TESTS.parent / "decks"
SHIPPED = [
    path
    for path in sorted(DECKS.rglob("*"))
    if path.suffix in (".dat", ".DAT", ".vsdf") and path.stem not in OF_SPARSE_MATRICES
]
# Files of the tests with lists of decks that are wrong in a way each.
BAD = {
    "dialects.young.test_bad_young_decks": ["CASES"],
    "dialects.young.test_bad_young_models": ["CASES"],
    "dialects.young.test_bad_young_constraints": ["CASES"],
    "dialects.young.test_bad_young_counts": ["CASES"],
    "dialects.dafms.test_dafms_body_faults": ["CASES"],
    "dialects.dafms.test_dafms_function_faults": ["CASES"],
    "dialects.dafms.test_dafms_closure_faults": ["CASES"],
    "dialects.vsdf.test_bad_vsdf_decks": ["READING"],
    "dialects.vsdf.test_bad_rigid_bodies": ["RIGID_MODELS"],
    "dialects.vsdf.test_bad_flexible_bodies": ["FLEXIBLE_MODELS"],
}
# Ends at the first command that loads what it should not.
CHILD = """
import click, contextlib, os, sys
from flexmb_cli.cli import cli
from flexmb_cli.errors import FlexmbError

for line in sys.stdin:
    with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere), contextlib.suppress(
        SystemExit, FlexmbError, click.ClickException
    ):
        cli.main(line.rstrip("\\n").split("\\t"), standalone_mode=False)
    loaded = {"numba", "scipy"} & set(sys.modules)
    if loaded:
        sys.exit(f"{line} loads {loaded}")
"""


def assert_light(commands, folder):
    """The commands, one after the other in one process, load neither numba nor scipy."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA")}
    done = subprocess.run(
        [sys.executable, "-c", CHILD], input="".join("\t".join(map(str, line)) + "\n" for line in commands),
        capture_output=True, text=True, cwd=folder, timeout=300,
        # A flexible body that is kept from an earlier run would need no scipy in any case.
        env={**environment, "FLEXMB_CACHE_DIR": str(folder / "cache"), "OPENBLAS_NUM_THREADS": "1"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


def bad_decks(folder):
    """The bad decks of the tests, a file each, beside the matrices of the supplied ones."""
    (folder / "fe").symlink_to(DECKS / "vsdf" / "fe")
    for name, lists in BAD.items():
        module = importlib.import_module(f"tests.{name}")
        cases = [case for one in lists for case in getattr(module, one)]
        for number, case in enumerate(cases):
            values = getattr(case, "values", None)
            path = folder / f"{name}-{number}.dat"
            path.write_text(values[0] if values else case[1])
            yield path


def unreachable(folder):
    """Linkages that no position puts together."""
    function, time = (0.5, 1, 0), (0, 1, 0.1)
    texts = four_bar(10, 1, 2, 1, function, time), slider_crank(1, 0.2, function, time)
    for number, text in enumerate(texts):
        path = folder / f"unreachable-{number}.dat"
        path.write_text(text)
        yield path


@pytest.mark.parametrize("every", [pytest.param(1, marks=pytest.mark.campaign), 4])
def test_check_of_supplied_decks(tmp_path, every):
    assert_light([["check", "-q", deck] for deck in SHIPPED[::every]], tmp_path)


def test_check_of_bad_decks(tmp_path):
    decks = [*bad_decks(tmp_path), *unreachable(tmp_path)]
    assert len(decks) > 150
    assert_light([["check", "-q", deck] for deck in decks], tmp_path)


def files_of_every_kind(folder):
    """Listings and series of the dialects, results, tables of studies, and files of no kind."""
    yield write_result(folder / "result.h5", 3)
    head = TableHead("", "", "a.dat", "0" * 64, (Column("result/top", "m", "max of point.1.z"),), 1)
    write_table(str(folder / "study.h5"), head, [(1, 0, 3, "", [0.1])])
    yield folder / "study.h5"
    yield from sorted((TESTS / "published" / "dafms").glob("*.OUT"))
    texts = {
        "series.T2": "   0.0000000   0.0000000   0.000000E+00   0.872665E-01\n",
        "OUT.dat": "TIME= 0.000\n-----\nPOSITION\nBODY X Y Z e0 e1 e2 e3\n 1 0.0 0.0 0.0 1.0 0.0 0.0 0.0\n",
        "study.parquet": "PAR1 PAR1",
        "empty": "",
    }
    for name, text in texts.items():
        (folder / name).write_text(text)
        yield folder / name
    yield folder


@pytest.mark.parametrize("command", ["diff", "table", "table --list"])
def test_what_reads_results(command, tmp_path, monkeypatch):
    files = files_of_every_kind(tmp_path)
    word, *options = command.split()
    others = {"diff": lambda path: [path], "table": lambda path: ["*"]}[word]
    assert_light([[word, path, *others(path), *options] for path in files], tmp_path)
