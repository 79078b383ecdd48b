"""Random damage to the bytes of a file: words, digits, lines, pieces; for texts and for binary files."""

import random
import struct
from collections.abc import Callable

Damage = Callable[[random.Random, bytes, bytes], bytes]

NUMBERS = (
    *("", "0", "-1", "1", "2.0", "7", "1e308", "-1e308", "1e-300", "5e-324", "1e999", "nan", "inf", "-0"),
    *(
        "0x3",
        "1_000",
        "1,5",
        "1.5D+03",
        "1.5+3",
        "2-1",
        "1e",
        "99999999999",
        "2147483648",
        "-9223372036854775808",
    ),
    *(
        "9" * 19,
        "9" * 400,
        "9" * 5000,
        "1e18",
        "999999*1.0",
        "1e99999999999",
        "123456789012345678901234567890",
    ),
)
WORDS = (
    *("O", "l", "{", "}", "{ a }", "#", "\t", "\r", "\n", "\0", "\x1a", "\x1b[2J", "\x9b", "é", "−1", "３"),
    *(
        "\ufeff",
        "\u2028",
        "\u202e",
        "²",
        "DFMB",
        "END",
        "STOP",
        "VSDF",
        "NBLOCK",
        "EBLOCK",
        "*NODE",
        "GRID",
        "-1",
    ),
    *('"', "[", "]]", "[[[[", "=", "\\u0000", "null", "true", "<script>", "\ud7ff", "TIME=", "*****"),
)
HUGE = (0, 1, -1, 2**31 - 1, -(2**31), 2**31, 2**32 - 1, 65536, 2**24)


def damaged_text(chance: random.Random, raw: bytes, other: bytes) -> bytes:
    """`raw` after one to four damages; some take pieces from `other`."""
    return _damaged(chance, raw, other, TEXT_DAMAGES)


def damaged_bytes(chance: random.Random, raw: bytes, other: bytes) -> bytes:
    """A binary `raw` after one to four damages."""
    return _damaged(chance, raw, other, BINARY_DAMAGES)


def _damaged(chance, raw, other, damages: tuple[Damage, ...]):
    for _ in range(chance.choice((1, 1, 1, 2, 3, 4))):
        raw = chance.choice(damages)(chance, raw, other)
    return raw


def _nasty(chance):
    return chance.choice(chance.choice((NUMBERS, WORDS))).encode("utf-8", "surrogatepass")


def _drop_word(chance, raw, _other):
    words = raw.split(b" ")
    del words[chance.randrange(len(words))]
    return b" ".join(words)


def _replace_word(chance, raw, _other):
    words = raw.split(b" ")
    words[chance.randrange(len(words))] = _nasty(chance)
    return b" ".join(words)


def _replace_number(chance, raw, _other):
    """A number, as far as digits go, in the place of another; commas and column edges stay."""
    at = chance.randrange(len(raw) + 1)
    start = next((k for k in range(at, len(raw)) if raw[k] in b"0123456789"), None)
    if start is None:
        return raw
    end = next((k for k in range(start, len(raw)) if raw[k] not in b"0123456789.eED+-"), len(raw))
    return raw[:start] + chance.choice(NUMBERS).encode() + raw[end:]


def _insert(chance, raw, _other):
    at = chance.randrange(len(raw) + 1)
    return raw[:at] + _nasty(chance) + raw[at:]


def _change_digit(chance, raw, _other):
    at = chance.randrange(len(raw) + 1)
    at = next((k for k in range(at, len(raw)) if raw[k] in b"0123456789"), None)
    return raw if at is None else raw[:at] + bytes([chance.choice(b"0123456789-. ")]) + raw[at + 1 :]


def _change_byte(chance, raw, _other):
    at = chance.randrange(len(raw) + 1)
    return raw[:at] + bytes([chance.randrange(256)]) + raw[at + 1 :]


def _flip_bit(chance, raw, _other):
    if not raw:
        return raw
    at = chance.randrange(len(raw))
    return raw[:at] + bytes([raw[at] ^ 1 << chance.randrange(8)]) + raw[at + 1 :]


def _set_integer(chance, raw, _other):
    """A count or an offset that is far too large, or nothing, in any byte order and width."""
    form = chance.choice("<>") + chance.choice("iqH")
    value = chance.choice(HUGE) % 256 ** struct.calcsize(form)
    coded = value.to_bytes(struct.calcsize(form), "little" if form[0] == "<" else "big")
    at = chance.randrange(len(raw) + 1)
    return raw[:at] + coded + raw[at + len(coded) :]


def _truncate(chance, raw, _other):
    return raw[: chance.randrange(len(raw) + 1)]


def _cut_out(chance, raw, _other):
    at = chance.randrange(len(raw) + 1)
    return raw[:at] + raw[at + chance.randrange(1, 64) :]


def _zero(chance, raw, _other):
    at, length = chance.randrange(len(raw) + 1), chance.randrange(1, 64)
    return raw[:at] + b"\0" * length + raw[at + length :]


def _drop_line(chance, raw, _other):
    lines = raw.split(b"\n")
    del lines[chance.randrange(len(lines))]
    return b"\n".join(lines)


def _double_line(chance, raw, _other):
    lines = raw.split(b"\n")
    at = chance.randrange(len(lines))
    return b"\n".join(lines[: at + 1] + lines[at:])


def _swap_lines(chance, raw, _other):
    lines = raw.split(b"\n")
    a, b = (chance.randrange(len(lines)) for _ in range(2))
    lines[a], lines[b] = lines[b], lines[a]
    return b"\n".join(lines)


def _splice(chance, raw, other):
    return raw[: chance.randrange(len(raw) + 1)] + other[chance.randrange(len(other) + 1) :]


def _line_ends(chance, raw, _other):
    return raw.replace(b"\n", chance.choice((b"\r\n", b"\r", b" ", b"\n\n")))


TEXT_DAMAGES: tuple[Damage, ...] = (
    *(_drop_word, _replace_word, _replace_number, _replace_number, _insert, _change_digit, _change_digit),
    *(_change_byte, _truncate, _drop_line, _double_line, _swap_lines, _splice, _line_ends),
)
BINARY_DAMAGES: tuple[Damage, ...] = (
    *(_flip_bit, _flip_bit, _change_byte, _set_integer, _set_integer, _zero, _insert),
    *(_truncate, _cut_out, _splice),
)
