"""Records in the folder of a study that this study cannot have written: their cases are solved anew.

They ended in faults of flexmb.  One of 3 GB that takes no room on the disk took 3.2 GB of memory, and one of
131,072 values was taken.
"""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.study.solver import CaseResult
from flexmb_cli.study.sweep import Sweep

DECK = Path(__file__).resolve().parents[2] / "decks/young/IN1-3-1.dat"
STUDY = """
deck = "{deck}"
[parameters]
"point.1.x" = {{ from = 0.0, to = 1.0, count = 4 }}
[results]
top = "{take} point.1.z"
"""
NO_SERIES = (0, 0)


@pytest.mark.parametrize(
    ("take", "parameters", "values", "series"),
    [
        ("max", 1, 2**17, NO_SERIES),
        ("max", 1, 0, NO_SERIES),
        ("max", 0, 1, NO_SERIES),
        ("max", 1, 0, (1, 3)),
        ("series", 1, 1, NO_SERIES),
        ("series", 1, 0, (1, 3)),
    ],
)
def test_a_record_of_another_form_is_not_taken(tmp_path, monkeypatch, take, parameters, values, series):
    monkeypatch.chdir(tmp_path)
    Path("s.toml").write_text(STUDY.format(deck=DECK, take=take))
    begun = Sweep.of("s.toml", "s.h5.parts")
    with begun.job.part(0) as part:
        part.append([CaseResult(0, 0, 1, np.zeros(parameters), np.zeros(values), np.zeros(series))])
    begun.lock.leave()
    for table in ("s.h5", "undisturbed.h5"):
        assert CliRunner().invoke(cli, ["sweep", "s.toml", "-q", "-o", table]).exit_code == 0
    assert Path("s.h5").read_bytes() == Path("undisturbed.h5").read_bytes()
