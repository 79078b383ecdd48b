"""What a stranger may have named or typed does not command the terminal that shows the message."""

import subprocess
import sys

import pytest

pytestmark = pytest.mark.processes

ESCAPES = "\x1b[2J\x9b1m\u202e\x07"
CASES = {
    "a deck by its name": ["check", f"{ESCAPES}.dat"],
    "a result by its name": ["table", f"{ESCAPES}.h5", "time"],
    "an option's value": ["diff", "a", "b", "--tol", f"{ESCAPES}=1"],
    "a study by its name": ["sweep", f"{ESCAPES}.toml"],
}


@pytest.mark.parametrize("case", CASES)
def test_control_characters_are_shown_as_marks(tmp_path, case):
    done = subprocess.run(
        [sys.executable, "-m", "flexmb_cli", *CASES[case]], cwd=tmp_path, capture_output=True, timeout=120
    )
    message = done.stderr.decode("utf-8")
    assert done.returncode == 2
    assert "�" in message
    assert not set(ESCAPES) - set("[2J1m") & set(message)
