"""Bodies kept on disk: found again, told apart, made anew when anything they depend on changes."""

import os
import sys
import threading
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.errors import ModelError
from flexmb_cli.fe import flexible_bodies as cache
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.kernels import _cache
from flexmb_cli.model.flexible_body import FlexibleBody
from tests.fe.trusses import files_input, truss, truss_input


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("FLEXMB_CACHE_DIR", str(tmp_path / "cache"))
    return tmp_path


def kept():
    return sorted(cache.cache_folder().iterdir())


def test_a_body_comes_back_bit_for_bit(folder):
    given = truss_input(folder, 1, reference=(11, 13, 16), modes=4, damping=(0.1, 0.2, 0.3))
    made, _ = flexible_body(given)
    found, _ = flexible_body(given)
    assert len(kept()) == 1
    for item in fields(FlexibleBody):
        before, after = getattr(made, item.name), getattr(found, item.name)
        if isinstance(before, np.ndarray):
            assert before.tobytes() == after.tobytes()
        else:
            assert repr(before) == repr(after)


def test_a_kept_body_is_not_computed_again(folder, monkeypatch):
    given = truss_input(folder, 1, modes=2)
    flexible_body(given)
    monkeypatch.setattr("flexmb_cli.fe.reduction.reduced_body", None)
    assert flexible_body(given)[0].modes == 2


@pytest.mark.parametrize(
    "change",
    [
        {"modes": 3},
        {"reference": (12, 13, 16)},
        {"clamped": (11, 13, 16)},
        {"attachment": (15,)},
        {"damping": (0.0, 0.0, 0.01)},
    ],
    ids=lambda change: next(iter(change)),
)
def test_another_setting_makes_another_body(folder, change):
    given = truss_input(folder, 1, reference=(11, 13, 16), modes=4)
    flexible_body(given)
    flexible_body(replace(given, **change))
    assert len(kept()) == 2


def test_a_changed_file_of_the_same_name_makes_another_body(folder):
    first, _ = flexible_body(truss_input(folder, 1, modes=2))
    r, _, M, K = truss(1)
    second, _ = flexible_body(files_input(folder, r, M, 4 * K, modes=2))
    assert second.frequencies == pytest.approx(2 * first.frequencies)
    assert len(kept()) == 2


def test_moved_nodes_make_another_body(folder):
    given = truss_input(folder, 1, modes=2)
    assert cache.key_of(given) != cache.key_of(replace(given, positions=given.positions + 1.0))


def test_the_place_of_the_files_does_not_matter(folder):
    given = truss_input(folder, 1, modes=2)
    (folder / "elsewhere").mkdir()
    moved = truss_input(folder / "elsewhere", 1, modes=2)
    assert cache.key_of(given) == cache.key_of(moved)


@pytest.mark.parametrize(
    "spoil", [b"", b"not a zip file", b"PK\x03\x04 cut off"], ids=["empty", "text", "cut"]
)
def test_a_spoilt_file_is_made_anew(folder, spoil):
    given = truss_input(folder, 1, modes=2)
    made, _ = flexible_body(given)
    kept()[0].write_bytes(spoil)
    found, _ = flexible_body(given)
    assert found.frequencies == pytest.approx(made.frequencies)
    assert cache.load(given) is not None


@pytest.mark.parametrize("content", [b"", b"\x93NUMPY", b"text"])
def test_other_content_with_a_right_digest_is_made_anew(folder, content):
    given = truss_input(folder, 1, modes=2)
    flexible_body(given)
    kept()[0].write_bytes(content + cache._digest(cache.key_of(given), content))
    assert cache.load(given) is None


@pytest.mark.skipif(sys.platform == "win32", reason="modes are Unix's")
def test_a_file_that_others_may_write_is_made_anew(folder):
    """Their numbers would count as those of the deck's files."""
    given = truss_input(folder, 1, modes=2)
    flexible_body(given)
    kept()[0].chmod(0o620)
    assert cache.load(given) is None
    flexible_body(given)
    assert cache.load(given) is not None


def test_a_file_under_the_name_of_another_body_is_made_anew(folder):
    given = truss_input(folder, 1, modes=2)
    other = replace(given, modes=3)
    flexible_body(given)
    os.rename(kept()[0], kept()[0].with_name(f"{cache.key_of(other)}.body"))
    assert cache.load(other) is None
    assert flexible_body(other)[0].modes == 3


@pytest.mark.skipif(sys.platform == "win32", reason="modes are Unix's")
def test_compiled_kernels_find_a_safe_folder_where_bodies_were_kept_first(folder, monkeypatch):
    """With umask 002 the folder "flexmb" was made for a group to write, and then refused for kernels."""
    before = os.umask(0o002)
    try:
        assert cache.cache_folder() == folder / "cache/flexmb/bodies"
        monkeypatch.setenv("NUMBA_CACHE_DIR", str(folder / "cache"))
        assert next(_cache.folders()).parent == folder / "cache/flexmb"
    finally:
        os.umask(before)


def test_doubts_are_told_again_from_the_cache(folder):
    """A mass that differs by 1e-5 between the directions is doubtful, not wrong."""
    r, _, M, K = truss(1)
    M[0, 0] *= 1 + 1e-5
    given = files_input(folder, r, M, K, modes=2)
    _, first = flexible_body(given)
    _, second = flexible_body(given)
    assert len(first) == 1
    assert first == second


def test_a_folder_that_cannot_be_made_costs_only_time(folder, monkeypatch):
    (folder / "file").write_text("")
    monkeypatch.setenv("FLEXMB_CACHE_DIR", str(folder / "file"))
    for name in ("XDG_CACHE_HOME", "LOCALAPPDATA", "HOME"):
        monkeypatch.delenv(name, raising=False)
    assert cache.cache_folder() is None
    assert flexible_body(truss_input(folder, 1, modes=2))[0].modes == 2


def test_nothing_but_whole_files_is_left_behind(folder):
    flexible_body(truss_input(folder, 1, modes=2))
    assert [path.suffix for path in kept()] == [".body"]
    assert Path(kept()[0]).stat().st_size > 1000


def test_whole_arrays_with_other_numbers_are_made_anew(folder):
    """Only a digest over all of them tells that one was exchanged."""
    given = truss_input(folder, 1, modes=2)
    made, _ = flexible_body(given)
    raw = Path(kept()[0]).read_bytes()
    mass = np.float64(made.m).tobytes()
    assert raw.count(mass) == 1
    Path(kept()[0]).write_bytes(raw.replace(mass, np.float64(7.0).tobytes()))
    found, _ = flexible_body(given)
    assert found.m == made.m != 7.0


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes with names")
def test_a_pipe_in_the_place_of_a_matrix_is_refused_not_waited_for(folder):
    """The hash of the cache waited for it; a device without end filled the memory."""
    given = truss_input(folder, 1)
    given.mass.path.unlink()
    os.mkfifo(given.mass.path)
    fed = threading.Timer(60.0, lambda: os.open(given.mass.path, os.O_RDWR))  # ends the wait, if there is one
    fed.daemon = True
    fed.start()
    with pytest.raises(ModelError, match="not a regular file"):
        flexible_body(given)
    assert fed.is_alive(), "it waited"
    fed.cancel()
