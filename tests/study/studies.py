"""Studies for the tests of `flexmb sweep`, and the command."""

import subprocess
import sys
from pathlib import Path

RSSR = Path(__file__).resolve().parents[2] / "decks/young/IN-RSSR.dat"
FLEXMB = [sys.executable, "-m", "flexmb_cli"]

SMALL = """
deck = "{deck}"
[parameters]
"driver.1.B" = [100.0, 146.6, 150]
"point.1.x" = [0.0, 0.05]
[results]
top = "max point.1.z"
last = "last body.2.omega.x"
path = "series point.1.y"
"""
SAMPLED = """
deck = "{deck}"
sampling = "latin-hypercube"
count = {count}
seed = 7
[parameters]
"driver.1.B" = {{ from = 100.0, to = 200.0 }}
"point.1.x" = {{ from = 0.001, to = 1.0, scale = "log" }}
[results]
mean = "mean point.1.z"
"""
# Estimates are no numbers that a model only passes on.
OWN_MODELS = SAMPLED.replace(
    '"point.1.x" = {{ from = 0.001, to = 1.0', '"body.3.x" = {{ from = 0.001, to = 0.01'
)


def written(folder, text, **values):
    folder.mkdir(exist_ok=True)
    path = folder / "study.toml"
    path.write_text(text.format(deck=RSSR, **values))
    return path


def flexmb(*arguments, cwd, check=True):
    done = subprocess.run([*FLEXMB, *map(str, arguments)], cwd=cwd, capture_output=True, text=True)
    assert done.returncode == 0 or not check, done.stderr
    return done
