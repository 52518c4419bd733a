"""Runs a program that the kernel ends at its first network call or its first start of another program (Linux, x86-64).

   confine.py PROGRAM [ARGUMENT]...    ends by SIGSYS when the program, or any process that it forks, tries either.
"""

import ctypes
import os
import struct
import sys

PR_SET_NO_NEW_PRIVS, PR_SET_SECCOMP, SECCOMP_MODE_FILTER = 38, 22, 2
KILL_PROCESS, ALLOW = 0x80000000, 0x7FFF0000
NUMBER, FIRST_LOW, FIRST_HIGH = 0, 16, 20  # offsets in struct seccomp_data
LOAD, EQUAL, RETURN = 0x20, 0x15, 0x06  # BPF_LD|W|ABS, BPF_JMP|JEQ|K, BPF_RET|K
NETWORK = {41: "socket", 42: "connect", 43: "accept", 49: "bind", 50: "listen", 53: "socketpair", 288: "accept4"}
EXECVE, EXECVEAT = 59, 322


def instruction(code, k, true=0, false=0):
    return struct.pack("HBBI", code, true, false, k)


def rules(path_address):
    """The filter: no call of NETWORK, no execveat, and execve with this very pointer only, which is that of our own."""
    program = [instruction(LOAD, NUMBER)]
    for number in (*NETWORK, EXECVEAT):
        program += [instruction(EQUAL, number, 0, 1), instruction(RETURN, KILL_PROCESS)]
    program += [instruction(EQUAL, EXECVE, 0, 5),
                instruction(LOAD, FIRST_LOW), instruction(EQUAL, path_address & 0xFFFFFFFF, 0, 2),
                instruction(LOAD, FIRST_HIGH), instruction(EQUAL, path_address >> 32, 1, 0),
                instruction(RETURN, KILL_PROCESS), instruction(RETURN, ALLOW)]
    return program


def confine(arguments):
    libc = ctypes.CDLL(None, use_errno=True)
    path = ctypes.create_string_buffer(os.fsencode(arguments[0]))
    program = rules(ctypes.addressof(path))
    code = ctypes.create_string_buffer(b"".join(program))
    table = struct.pack("HxxxxxxQ", len(program), ctypes.addressof(code))
    argv = (ctypes.c_char_p * (len(arguments) + 1))(*map(os.fsencode, arguments), None)
    words = [f"{name}={value}".encode() for name, value in os.environ.items()]
    environment = (ctypes.c_char_p * (len(words) + 1))(*words, None)
    if libc.prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) or libc.prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, table, 0, 0):
        sys.exit(f"confine.py: the kernel takes no filter: {os.strerror(ctypes.get_errno())}")
    libc.execve(path, argv, environment)
    sys.exit(f"confine.py: {arguments[0]}: {os.strerror(ctypes.get_errno())}")


if __name__ == "__main__":
    confine(sys.argv[1:])
