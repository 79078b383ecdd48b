"""Run the decks of the documentation and draw its pictures, the gallery and the page of the sources.

    python docs/_ext/pictures.py [--readme]

`--readme` draws those of the README and of the formats alone, which are kept in the repository.
"""

import subprocess
import sys
from pathlib import Path

import h5py
from deck_picture import draw_mechanism
from deck_runs import DOCS, RESULTS, TOP, digest, flexmb, program, solved
from gallery import gallery
from joint_drawings import main as joint_drawings

PICTURES = DOCS / "pictures"
REPRODUCTION = TOP / "scripts" / "reproduction"
PUBLISHED = TOP / "tests" / "published"
# Pictures of the tutorial: deck, quantities, other options, file.
FIGURES = [
    ("young/IN4-BAR.dat", ["body.3.velocity"], ["--width", "110"], "four-bar-velocity.svg"),
    ("young/IN4-BAR.dat", ["point.1.z"], ["--x", "point.1.y", "--width", "80"], "four-bar-path.png"),
    (
        "dafms/two_link_n2.DAT",
        ["elastic.1.node2.z", "elastic.2.node2.z"],
        ["--to", "0.5", "--width", "110"],
        "two-link-tips.svg",
    ),
    ("vsdf/pendulum.vsdf", ["point.1.position"], ["--width", "110"], "pendulum.svg"),
]

# Machines beside their decks in the pages of the formats.
MACHINES = ("young/IN4-BAR.dat", "dafms/sliding_mass.DAT", "vsdf/pendulum_ccx.vsdf")

# Those of a study: the study, result, other options, file.
STUDY_FIGURES = [("studies/rssr.toml", "path", ["--width", "85"], "study.png")]


def figures() -> None:
    """Draw the pictures of the tutorial."""
    results = solved([TOP / "decks" / deck for deck, *_ in FIGURES])
    smooth = TOP / "decks/young/IN4-BAR.dat"
    paths = solved([smooth], "--set", "time.step=0.01")
    for deck, names, options, target in FIGURES:
        found = paths[smooth] if "--x" in options else results[TOP / "decks" / deck]
        flexmb("plot", found, *names, *options, "-q", "-o", PICTURES / target)
    for study, result, options, target in STUDY_FIGURES:
        table = RESULTS / f"{Path(study).stem}.h5"
        flexmb("sweep", TOP / "decks" / study, "-q", "--fresh", "-o", table)
        flexmb("plot", table, result, *options, "-q", "-o", PICTURES / target)
    rotor = TOP / "decks/vsdf/rotor.vsdf"
    over = ["--over", "velocity.1.w.x", "0", "400", "21", "--frequencies", "0", "150", "--order", "1"]
    flexmb("modes", rotor, *over, "-q", "--locus", PICTURES / "campbell.png")


def sources() -> None:
    """Run the examples of the three sources: docs/verification/reproduced.md and its pictures."""
    page = DOCS / "verification" / "reproduced.md"
    folder = PICTURES / "reproduction"
    inputs = [
        path for where in (REPRODUCTION, PUBLISHED) for path in where.rglob("*") if path.suffix != ".pyc"
    ]
    decks = [path for path in (TOP / "decks").rglob("*") if path.is_file()]
    stamp = digest([path for path in (*inputs, *decks) if path.is_file()], program())
    kept = RESULTS / "reproduced"
    if page.exists() and kept.exists() and kept.read_text() == stamp:
        return
    command = [sys.executable, REPRODUCTION / "page.py", folder, "--markdown", page]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))} failed:\n{done.stdout}{done.stderr}")
    kept.write_text(stamp)


def of_readme(folder: Path = PICTURES) -> None:
    """Draw the slider-crank with the stresses of its rod as a film, and the curves of the ball."""
    decks = [TOP / "decks" / deck for deck in ("vsdf/slider_crank_stress.vsdf", "young/dynamics/IN-BALL.dat")]
    crank, ball = (solved([deck])[deck] for deck in decks)
    film = ["--size", "640x300", "--fps", "20", "--scale", "20"]
    flexmb("report", crank, "--movie", folder / "slider-crank.gif", *film, "-q")
    curves = ["body.2.position.x", "body.2.position.z"]
    flexmb("plot", ball, *curves, "--width", "120", "-q", "-o", folder / "ball.svg")
    machines(folder / "machines")


def machines(folder: Path) -> None:
    """Draw the machines that stand beside their decks."""
    folder.mkdir(exist_ok=True)
    for deck, result in solved([TOP / "decks" / deck for deck in MACHINES]).items():
        with h5py.File(result) as file:
            draw_mechanism(file, folder / f"{deck.parent.name}.png")


if __name__ == "__main__":
    RESULTS.mkdir(parents=True, exist_ok=True)
    PICTURES.mkdir(exist_ok=True)
    if "--readme" in sys.argv:
        of_readme()
        sys.exit()
    joint_drawings()
    figures()
    gallery()
    sources()
