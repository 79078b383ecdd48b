"""Resume files with right checksums and numbers that would lead compiled kernels out of their arrays.

Kernels check no bounds: such a file ended in a crash of the process, or in a loop that no signal ended.
"""

import numpy as np
import pytest

from flexmb_cli.run.checkpoint import ResumeFile
from tests.run.dafms_runs import stop_after
from tests.run.resume.test_resume_mechanisms import DECKS, TEXTS, rewritten, run, with_number
from tests.run.resume.test_resume_mechanisms import short_blocks as short_blocks


def with_field(name, number):
    """A field of the clock is another."""

    def changed(clock):
        clock = np.array(clock)
        clock[name] = number
        return clock

    return lambda arrays: {
        key: changed(array) if key.endswith("clock") else array for key, array in arrays.items()
    }


def with_first(name, number):
    """The first number of an array is another."""

    def changed(array):
        array = np.array(array)
        array.reshape(-1)[0] = number
        return array

    return lambda arrays: {key: changed(array) if key == name else array for key, array in arrays.items()}


PLACES = {
    "an order with one equation twice": with_first("work/order", 1),
    "a column beyond the last": with_number("work/order", 10**9),
    "a rank below 0": with_number("work/rank", -1),
    "a rank above the equations": with_number("work/rank", 10**6),
    "a column that no body has": with_first("work/columns", 10**6),
    "places before the first": with_first("work/entries", -3),
    "places after the last": with_first("work/entries", 10**6),
}
CLOCKS = {
    "more components than the state has": with_field("counted", 10**9),
    "a looser tolerance": with_field("rtol", 1e3),
    "a place before the state": with_field("worst", -5),
    "an equation too many": with_field("equation", 10**6),
}
CASES = [
    *(("rk45.vsdf", name, change) for name, change in (PLACES | CLOCKS).items()),
    *(("IN-INVERSE.dat", name, change) for name, change in PLACES.items()),
    *(("IN-GALF.dat", name, change) for name, change in CLOCKS.items()),
    *(("pendulum.DAT", name, change) for name, change in CLOCKS.items()),
]


@pytest.mark.parametrize(("name", "change"), [pytest.param(n, c, id=f"{n}-{what}") for n, what, c in CASES])
def test_places_beyond_their_arrays_are_refused(tmp_path, name, change):
    deck = tmp_path / name
    deck.write_text(TEXTS[name] if name in TEXTS else (DECKS / f"dafms/{name}").read_text(encoding="utf-8"))
    run(deck, tmp_path, stop_after(2))
    (path,) = tmp_path.glob("*.resume")
    rewritten(path, change)
    outcome = run(deck, tmp_path, resume=True)
    assert [fault.id for fault in outcome.faults if fault.severity == "error"] == ["RUN-040"]
    assert outcome.exit_code == 2


@pytest.mark.parametrize(
    "names",
    [
        np.array([1.0]),
        np.zeros(2, [("a", "f8"), ("b", "S3")]),
        np.array([b".flexmb-0123456789ab.tmp"]),
        np.array([".flexmb-0123456789a\ud800.tmp", ".flexmb-0\x00123456789ab.tmp"]),
        np.array([0x7FFFFFFF] * 4, "<u4").view("<U4"),
    ],
    ids=["numbers", "records", "bytes", "no names of files", "no characters"],
)
def test_unfinished_files_without_names_are_left_out(tmp_path, names):
    """They ended in a fault of flexmb itself."""
    path = tmp_path / "x.resume"
    written = ResumeFile(str(path), {"deck": "x"})
    written.begin([])
    written.append({"unfinished": names}, {})
    written.close()
    found = ResumeFile(str(path), {"deck": "x"})
    found.find()
    assert not found.warnings
    found.close()
