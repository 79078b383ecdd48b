"""Objects of x86-64 Linux, loaded without LLVM: sections are placed, relocated and made executable.

System V Application Binary Interface, AMD64 Architecture Processor Supplement, section 4.4 (relocation);
Tool Interface Standard (TIS), Executable and Linking Format, version 1.2, book I.  llvmlite does the same
and gives the same code, but importing it takes a quarter of the time of importing numpy, h5py and click.
"""

import ctypes
import functools
import mmap
import struct
from typing import Any, NamedTuple

import numpy as np

_SYMBOL = np.dtype(
    [
        ("name", "<u4"),  # offset of the name in the table of strings, bytes
        ("info", "u1"),  # binding in the upper half, type in the lower one
        ("other", "u1"),  # visibility
        ("section", "<u2"),  # number of its section, 0: undefined
        ("value", "<i8"),  # offset in its section, bytes
        ("size", "<i8"),  # bytes
    ]
)
_RELOCATION = np.dtype(
    [
        ("offset", "<i8"),  # of the place to fill, in its section, bytes
        ("kind", "<u4"),  # R_X86_64_…
        ("symbol", "<u4"),  # number of the symbol
        ("addend", "<i8"),  # added to the symbol's address, bytes
    ]
)
_SYMBOLS, _RELOCATIONS, _EMPTY = 2, 4, 8  # SHT_SYMTAB, SHT_RELA, SHT_NOBITS
_WRITABLE, _IN_MEMORY = 1, 2  # SHF_WRITE, SHF_ALLOC
_READ_ONLY_AFTER_RELOCATION = b".data.rel.ro"
_ADDRESS, _DISTANCE, _CALL = 1, 2, 4  # R_X86_64_64, R_X86_64_PC32, R_X86_64_PLT32
_WIDTHS = {_ADDRESS: 8, _DISTANCE: 4, _CALL: 4}
# jmp *0(%rip), with the address behind it: libraries lie further away than the 32 bits of a call reach.
_JUMP, _JUMP_SIZE = b"\xff\x25\0\0\0\0", 16
_REACH = 2**31


class NotLoadedError(Exception):
    """An object that only LLVM can load."""


class _Section(NamedTuple):
    """An entry of the section header table."""

    name: int  # offset of the name in the table of strings, bytes
    kind: int  # SHT_…
    flags: int  # SHF_…, or'ed
    address: int  # in memory; 0 in objects
    offset: int  # in the file, bytes
    size: int  # bytes
    link: int  # number of the section that belongs to it, such as the strings of symbols
    info: int  # number of the section that relocations are for
    alignment: int  # bytes
    entry_size: int  # bytes, of a table


class LoadedObject:
    """The code of an object in memory, which stays there as long as this does."""

    def __init__(self, code: bytes):
        self._code = code
        self._sections = self._section_table()
        self._table = next(one for one in self._sections if one.kind == _SYMBOLS)
        self._symbols = self._entries(self._table, _SYMBOL)
        undefined = np.flatnonzero(self._symbols["section"] == 0)[1:].tolist()
        self._places, jumps = self._laid_out()
        self._memory = np.frombuffer(_private_memory(jumps + _JUMP_SIZE * len(undefined)), np.uint8)
        self._base = self._memory.ctypes.data
        self._copy_sections()
        self._addresses = self._symbol_addresses()
        for k, symbol in enumerate(undefined):
            self._addresses[symbol] = self._add_jump(jumps + _JUMP_SIZE * k, self._name(symbol))
        self._relocate()
        self._make_executable()

    def get_function_address(self, name: str) -> int:
        """Return where a function begins."""
        for k in np.flatnonzero(self._symbols["info"] >> 4).tolist():  # those that are seen from outside
            if self._name(k) == name:
                return int(self._addresses[k])
        raise KeyError(name)

    def _section_table(self):
        (first,) = struct.unpack_from("<Q", self._code, 40)
        size, count = struct.unpack_from("<HH", self._code, 58)
        places = range(first, first + size * count, size)
        return [_Section(*struct.unpack_from("<IIQQQQIIQQ", self._code, place)) for place in places]

    def _entries(self, section: Any, kind: Any):
        return np.frombuffer(self._code, kind, section.size // kind.itemsize, section.offset)

    def _text(self, table: int, offset: int):
        """The name at `offset` of a string table."""
        begin = self._sections[table].offset + offset
        return self._code[begin : self._code.index(b"\0", begin)]

    def _name(self, symbol: int):
        return self._text(self._table.link, int(self._symbols["name"][symbol])).decode()

    def _laid_out(self):
        """Return where each section begins in memory, and where all end."""
        (names,) = struct.unpack_from("<H", self._code, 62)
        places, end = {}, 0
        for k, section in enumerate(self._sections):
            if section.flags & _IN_MEMORY:
                fixed = self._text(names, section.name).startswith(_READ_ONLY_AFTER_RELOCATION)
                if section.flags & _WRITABLE and not fixed:
                    raise NotLoadedError("a section that the code writes to")
                places[k] = end = _rounded_up(end, section.alignment)
                end += section.size
        return places, _rounded_up(end, _JUMP_SIZE)

    def _copy_sections(self) -> None:
        for k, place in self._places.items():
            section = self._sections[k]
            if section.kind != _EMPTY:
                content = np.frombuffer(self._code, np.uint8, section.size, section.offset)
                self._memory[place : place + section.size] = content

    def _symbol_addresses(self):
        """Return where each symbol lies; 0 for those of sections that are not in memory."""
        begins = np.zeros(2**16, np.int64)
        for k, place in self._places.items():
            begins[k] = self._base + place
        begin = begins[self._symbols["section"]]
        return np.where(begin, begin + self._symbols["value"], 0)

    def _add_jump(self, place: Any, name: str):
        """Write the jump to a function of the C library; return its address."""
        jump = _JUMP + struct.pack("<q", _foreign_address(name))
        self._memory[place : place + len(jump)] = np.frombuffer(jump, np.uint8)
        return self._base + place

    def _relocate(self) -> None:
        for section in self._sections:
            if section.kind == _RELOCATIONS and section.info in self._places:
                found = self._entries(section, _RELOCATION)
                if not set(found["kind"].tolist()) <= _WIDTHS.keys():
                    raise NotLoadedError("a relocation of another type")
                for kind in _WIDTHS:
                    self._write_values(found[found["kind"] == kind], kind, self._places[section.info])

    def _write_values(self, relocations: np.ndarray, kind: Any, place: Any) -> None:
        """Write S + A, or S + A - P, of all relocations of a type."""
        offsets = place + relocations["offset"]
        addresses = self._addresses[relocations["symbol"]]
        values = addresses + relocations["addend"]
        if kind != _ADDRESS:
            values = values - (self._base + offsets)
        if not addresses.all() or (kind != _ADDRESS and np.any(np.abs(values) >= _REACH)):
            raise NotLoadedError("a symbol out of reach")
        width = _WIDTHS[kind]
        self._memory[offsets[:, None] + np.arange(width)] = values.view(np.uint8).reshape(-1, 8)[:, :width]

    def _make_executable(self) -> None:
        protect = ctypes.CDLL(None, use_errno=True).mprotect
        protect.argtypes = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int
        if protect(self._base, len(self._memory), mmap.PROT_READ | mmap.PROT_EXEC):
            raise NotLoadedError(f"memory cannot be made executable: errno {ctypes.get_errno()}")


def _rounded_up(size: int, step: int):
    return size + -size % max(1, step)


def _private_memory(size: int):
    """Pages of zeros that can be read and written."""
    flags = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS
    return mmap.mmap(-1, _rounded_up(max(1, size), mmap.PAGESIZE), flags, mmap.PROT_READ | mmap.PROT_WRITE)


def _foreign_address(name: str):
    """Return where the process has a function of the C library or its mathematics."""
    for library in (None, "libm.so.6"):
        try:
            return ctypes.cast(getattr(_library(library), name), ctypes.c_void_p).value
        except (AttributeError, OSError):
            continue
    raise NotLoadedError(f"no function {name}")


@functools.cache
def _library(name: str | None) -> ctypes.CDLL:
    """Return a library of the process, all of them for None; each makes classes of its own in Python."""
    return ctypes.CDLL(name)
