"""What may be installed beside flexmb: bounded where untested, locked with hashes on request."""

import re
import sys
import tomllib
from importlib.util import find_spec
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((TOP / "pyproject.toml").read_text())["project"]
LOCK = (TOP / "requirements.lock").read_text()
PINNED = re.findall(r"^([\w.-]+)==([\w.]+)", LOCK, re.MULTILINE)


def minor(version):
    return tuple(map(int, version.split(".")[:2]))


def test_numba_stops_below_the_minor_version_behind_the_locked_one():
    """Each minor version of numba compiles other code: none is allowed that no test has seen."""
    bound = next(item for item in PROJECT["dependencies"] if item.startswith("numba"))
    first, beyond = map(minor, re.fullmatch(r"numba>=([\d.]+),<([\d.]+)", bound).groups())
    locked = minor(dict(PINNED)["numba"])
    assert first <= locked and beyond == (locked[0], locked[1] + 1)


def test_every_file_of_the_lock_has_a_hash_and_none_a_place():
    entries = re.split(r"\n(?=\S)", LOCK.strip())
    assert len(entries) == len(PINNED) > 40
    assert all("--hash=sha256:" in entry for entry in entries)
    assert not re.search(r"https?:|file:|index|find-links", LOCK)


def test_the_lock_holds_all_that_flexmb_and_its_tests_need():
    extras = ("cluster", "docs", "movie", "parquet", "plot", "report", "test")
    optional = (item for extra in extras for item in PROJECT["optional-dependencies"][extra])
    wanted = [*PROJECT["dependencies"], *optional]
    names = {re.match(r"[\w-]+", item)[0].lower() for item in wanted} - {"flexmb"}
    assert names <= {name.lower() for name, _ in PINNED}


def test_every_h5py_allowed_leaves_out_the_time_stamps_of_groups():
    """h5py 3.15 is the first whose `track_times` of files and groups is off; stamps began at byte 54."""
    bound = next(item for item in PROJECT["dependencies"] if item.startswith("h5py"))
    assert minor(bound.removeprefix("h5py>=")) >= (3, 15)


def test_the_lowest_versions_are_those_of_every_extra_that_users_install():
    """`scripts/dependencies lowest` names the extras; each has lower bounds that it can take."""
    text = (TOP / "scripts/dependencies").read_text()
    named = set(re.findall(r'"([a-z]+)"', re.search(r"^names = \((.*?)\)", text, re.MULTILINE)[1]))
    extras = PROJECT["optional-dependencies"]
    assert named == set(extras) - {"test", "fuzz", "bench"}
    own = [item for name in named for item in extras[name] if not item.startswith("flexmb[")]
    assert all(re.match(r"[\w-]+>=[\d.]+", item) for item in own)


def test_no_test_is_skipped_for_a_package_that_the_extra_test_lacks():
    """VTK and the linters of CI files were in extras that continuous integration does not install."""
    asked = {
        name.partition(".")[0]
        for path in (TOP / "tests").rglob("*.py")
        for name in re.findall(r'importorskip\(\s*"([\w.]+)"', path.read_text(encoding="utf-8"))
    }
    assert asked > {"matplotlib", "plotly"}
    assert {name for name in asked - sys.stdlib_module_names if find_spec(name) is None} == set()
