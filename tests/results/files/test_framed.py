"""Growing files of payloads with length and checksum: what counts after a kill or a loss of power."""

import struct
import zlib

import pytest

from flexmb_cli.results.files.durable import framed, whole_payloads

HEAD = struct.Struct("<QI")
PAYLOADS = [b"first", b"", b"the third"]
WHOLE = b"".join(struct.pack("<QI", len(one), zlib.crc32(one)) + one for one in PAYLOADS)


def found(tmp_path, content):
    path = tmp_path / "file"
    path.write_bytes(content)
    with path.open("rb") as file:
        return [(payload, file.tell()) for payload in whole_payloads(file, HEAD)]


def test_payloads_come_back_with_the_place_behind_each(tmp_path):
    assert b"".join(framed(one, HEAD) for one in PAYLOADS) == WHOLE
    assert found(tmp_path, WHOLE) == [(b"first", 17), (b"", 29), (b"the third", 50)]


@pytest.mark.parametrize("end", [1, 8, 12, 20])
def test_a_torn_payload_does_not_count(tmp_path, end):
    assert [payload for payload, _ in found(tmp_path, WHOLE[:-end])] == PAYLOADS[:2]


@pytest.mark.parametrize("place", [0, 7, 9, 14])
def test_nothing_counts_from_a_damaged_byte_on(tmp_path, place):
    """A length of 2^56 bytes or more is not read: there is no such memory."""
    damaged = bytearray(WHOLE)
    damaged[17 + 12 + place] ^= 0xFF
    assert [payload for payload, _ in found(tmp_path, bytes(damaged))] == PAYLOADS[:2]
