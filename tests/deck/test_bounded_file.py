"""The beginning of a stream: no more than is wanted, and no room for more than there is."""

import io
import os
import tracemalloc

import pytest

from flexmb_cli.deck.text import first_bytes


@pytest.mark.parametrize("size", [0, 1, 5, 6, 7, 2**20 + 3])
@pytest.mark.parametrize("most", [6, 2**21])
def test_files_pipes_and_streams_give_their_first_bytes(size, most, tmp_path):
    content = os.urandom(size)
    path = tmp_path / "x"
    path.write_bytes(content)
    with path.open("rb") as stream:
        assert first_bytes(stream, most) == content[:most]
    assert first_bytes(io.BytesIO(content), most) == content[:most]
    if size < 2**16:  # what a pipe holds
        ends = os.pipe()
        os.write(ends[1], content)
        os.close(ends[1])
        with open(ends[0], "rb") as stream:
            assert first_bytes(stream, most) == content[:most]


def test_a_small_file_takes_no_room_for_the_largest(tmp_path):
    """Where memory was limited to 400 MB, listings of any size were refused."""
    (tmp_path / "x").write_bytes(b"one")
    tracemalloc.start()
    with (tmp_path / "x").open("rb") as stream:
        assert first_bytes(stream, 2**29) == b"one"
    assert tracemalloc.get_traced_memory()[1] < 100_000
    tracemalloc.stop()


@pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="a device of Linux")
def test_a_device_without_end_gives_what_is_wanted():
    with open("/dev/zero", "rb") as stream:
        assert first_bytes(stream, 3 * 2**20) == bytes(3 * 2**20)
