"""What every test leaves as it found it."""

import os
import signal

import pytest

from flexmb_cli.run.outcome import Stop
from flexmb_cli.run.processes.signal_mask import STOPS

# A worker of pytest-xdist has begun to measure; what it starts would take the longer for it.
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.pop("COVERAGE_PROCESS_CONFIG", None)


@pytest.fixture(autouse=True)
def stops_as_before():
    """A command that is called in this process hears signals, and holds them, until the process ends."""
    before = {number: signal.getsignal(number) for number in STOPS}
    yield
    Stop.asked, Stop.held = None, 0
    for number, heard in before.items():
        signal.signal(number, heard)
