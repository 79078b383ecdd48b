"""Start a command for which the system refuses executable memory: seccomp.py COMMAND...

The rules are systemd's of MemoryDenyWriteExecute (systemd.exec(5); src/shared/seccomp-util.c,
seccomp_memory_deny_write_execute): EPERM for mmap with PROT_WRITE and PROT_EXEC, for mprotect and
pkey_mprotect with PROT_EXEC, for shmat with SHM_EXEC; numbers of the system calls are those of x86-64.
"""

import ctypes
import errno
import os
import struct
import sys

WRITE, EXECUTE = 2, 4
RULES = ((9, WRITE | EXECUTE), (10, EXECUTE), (329, EXECUTE), (30, 0o100000))
NO_NEW_PRIVILEGES, SET_SECCOMP, FILTER = 38, 22, 2
ALLOWED, REFUSED = 0x7FFF0000, 0x00050000 | errno.EPERM
LOAD, MASK, IS_EQUAL, RETURN = 0x20, 0x54, 0x15, 0x06  # operations of classic BPF


class Program(ctypes.Structure):
    _fields_ = (("length", ctypes.c_ushort), ("instructions", ctypes.c_void_p))


def instructions():
    for number, bits in RULES:
        yield from ((LOAD, 0, 0, 0), (IS_EQUAL, 0, 4, number))
        yield from ((LOAD, 0, 0, 32), (MASK, 0, 0, bits), (IS_EQUAL, 0, 1, bits))  # the third argument
        yield (RETURN, 0, 0, REFUSED)
    yield (RETURN, 0, 0, ALLOWED)


if __name__ == "__main__":
    code = b"".join(struct.pack("HBBI", *one) for one in instructions())
    kept = ctypes.create_string_buffer(code)
    program = Program(len(code) // 8, ctypes.addressof(kept))
    system = ctypes.CDLL(None, use_errno=True)
    if system.prctl(NO_NEW_PRIVILEGES, 1, 0, 0, 0) or system.prctl(
        SET_SECCOMP, FILTER, ctypes.byref(program), 0, 0
    ):
        sys.exit(77)  # no filters here, as in some containers
    os.execv(sys.argv[1], sys.argv[1:])
