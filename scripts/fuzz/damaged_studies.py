"""Studies: their files, and the parts of a study that was stopped."""

import os
import shutil
import traceback
import warnings

from answer import Answer, answered
from damage import damaged_bytes, damaged_text
from damaged_decks import DECKS, unfit

from flexmb_cli.errors import DONE, FlexmbError

STUDY = """\
deck = "IN1-3-1.dat"
dialect = "auto"
sampling = "grid"

[parameters]
"driver.1.B" = { from = 1.0, to = 2.0, count = 2, scale = "linear" }
"body.1.x" = [0.0, 0.5]

[results]
top = "max body.1.z"
path = "series body.1.x"
"""
SAMPLE = """\
deck = "IN1-3-1.dat"
sampling = "latin-hypercube"
count = 3
seed = 7
[parameters]
"driver.1.B" = { from = 1.0, to = 2.0, scale = "log" }
[results]
top = "mean body.1.z"
"""


def study_seeds(folder):
    shutil.copy(DECKS / "young" / "IN1-3-1.dat", folder)
    (folder / "grid.toml").write_text(STUDY)
    (folder / "sample.toml").write_text(SAMPLE)
    shutil.copy(DECKS / "studies" / "rssr.toml", folder / "rssr.toml")


def prepare_study(chance, seeds, work):
    return prepared(_damaged_study(chance, seeds, work))


def prepared(path) -> Answer:
    """A study is prepared: read, its deck built, its names looked up."""
    from flexmb_cli.study.sweep import Sweep

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            Sweep.of(str(path), str(path.parent / "parts")).end()
    except FlexmbError as refused:
        return Answer(refused.exit_code, "", "", unfit("x.toml", refused.faults, ()))
    except Exception:
        return Answer(None, "", "", traceback.format_exc())
    return Answer(DONE, "", "")


def _damaged_study(chance, seeds, work):
    studies = sorted(seeds.glob("*.toml"))
    raw = damaged_text(chance, chance.choice(studies).read_bytes(), chance.choice(studies).read_bytes())
    os.link(seeds / "IN1-3-1.dat", work / "IN1-3-1.dat")
    (work / "x.toml").write_bytes(raw)
    return work / "x.toml"


def go_on_from_parts(chance, seeds, work):
    """A stopped study goes on from damaged parts."""
    for name in ("grid.toml", "IN1-3-1.dat"):
        os.link(seeds / name, work / name)
    arguments = ["sweep", str(work / "grid.toml"), "-o", str(work / "x.h5")]
    if not (seeds / "parts").exists():
        _leave_parts(seeds, arguments, work)
    shutil.copytree(seeds / "parts", work / "x.h5.parts", dirs_exist_ok=True)
    victim = chance.choice(sorted((work / "x.h5.parts").iterdir()))
    raw = victim.read_bytes()
    victim.write_bytes(damaged_bytes(chance, raw, raw))
    return answered(arguments)


def _leave_parts(seeds, arguments, work):
    from flexmb_cli.study.sweep import Sweep, solve_block

    made = Sweep.of(arguments[1], str(work / "first"))
    for block in made.pending():
        solve_block(made.job, block)
    shutil.copytree(work / "first", seeds / "parts")
