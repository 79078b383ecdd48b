"""What docs/how-to/untrusted-input.md promises of programs, connections, files and pages."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

DECKS = Path(__file__).resolve().parents[2] / "decks"

pytestmark = pytest.mark.processes

# Python tells of what a process does by audit events (https://docs.python.org/3/library/audit_events.html).
_AUDITED = """
import json, sys
heard = []
WATCHED = ("subprocess.", "os.exec", "os.posix_spawn", "os.spawn", "os.fork", "os.system", "pty.",
           "socket.connect", "socket.bind", "socket.getaddrinfo", "socket.sendto", "urllib.", "http.",
           "ftplib.", "smtplib.", "webbrowser.", "pickle.find_class")
begun = []
def hear(event, arguments):
    if begun and event.startswith(WATCHED):
        heard.append([event, repr(arguments)[:200]])
sys.addaudithook(hear)
from flexmb_cli.__main__ import main
for words in json.loads(sys.argv[1]):
    sys.argv = ["flexmb", *words]
    begun.append(words)
    try:
        main()
    except SystemExit as end:
        heard.append(["exit", end.code or 0])
    else:
        heard.append(["exit", 0])
print(json.dumps(heard), file=sys.stderr)
"""


def audited(folder, *commands):
    """Audit events of commands, one after the other in one process."""
    environment = os.environ | {"MPLCONFIGDIR": str(folder)}
    done = subprocess.run(
        [sys.executable, "-c", _AUDITED, json.dumps(commands)],
        cwd=folder, capture_output=True, text=True, timeout=300, env=environment,
    )  # fmt: skip
    return json.loads(done.stderr.splitlines()[-1])


# Libraries ask for the processor (h5py) and, once a user, for fonts (matplotlib).
_OF_LIBRARIES = ("uname", "fc-list", "lscpu")


def test_input_starts_no_other_program_and_opens_no_connection(tmp_path):
    pytest.importorskip("matplotlib")
    deck = str(DECKS / "young/IN1-1-1.dat")
    events = audited(
        tmp_path,
        ["run", "-q", deck, str(DECKS / "dafms/pendulum_strict.DAT")],
        ["check", "-q", deck],
        ["diff", "-q", "OUT1-1-1.h5", "OUT1-1-1.h5", "--words"],
        ["table", "OUT1-1-1.h5", "body.1.position.x"],
        ["plot", "OUT1-1-1.h5", "body.1.position", "-o", "x.svg"],
        ["report", "OUT1-1-1.h5", "-o", "x.html"],
        ["export", "OUT1-1-1.h5", "--to", "csv", "-o", "csv"],
        ["convert", str(DECKS / "dafms/spatial_rigid.DAT"), "--to", "mjcf", "-o", "x.xml"],
    )
    started = [
        event
        for event in events
        if event[0] != "exit" and not any(f"'{name}'" in event[1] for name in _OF_LIBRARIES)
    ]
    assert started == []
    codes = [event[1] for event in events if event[0] == "exit"]
    assert codes == 8 * [0]
    assert {"x.svg", "x.html"} <= {path.name for path in tmp_path.iterdir()}


def test_the_watch_hears_what_starts_a_program(tmp_path):
    """A test of the test above: here something does start one."""
    code = _AUDITED.replace("    try:\n", "    __import__('subprocess').run(['true'])\n    try:\n")
    done = subprocess.run(
        [sys.executable, "-c", code, json.dumps([["--version"]])], capture_output=True, text=True, timeout=60
    )
    heard = json.loads(done.stderr.splitlines()[-1])
    assert any(event[0] == "subprocess.Popen" for event in heard)
