"""Numbers in the text of the pages that no transcript shows: computed again, rounded as there."""

import re
import subprocess
import sys
from pathlib import Path

import h5py
import pytest

TOP = Path(__file__).resolve().parents[2]
DOCS = TOP / "docs"
VIEWER = TOP / "flexmb_cli/results/figures/viewer"
FLEXMB = [sys.executable, "-m", "flexmb_cli"]


def stated(page, pattern):
    """Numbers that `pattern` finds once in a page."""
    (found,) = re.findall(pattern, " ".join((DOCS / page).read_text(encoding="utf-8").split()))
    return found


@pytest.mark.processes
def test_the_pendulum_swings_with_the_frequency_of_the_tutorial():
    """The rod of 0.1 m, hinged at its end, nearly as a rigid one: sqrt(3 g / 2 l) / 2 pi."""
    deck = str(TOP / "decks/vsdf/pendulum.vsdf")
    done = subprocess.run(
        [*FLEXMB, "modes", deck, "--equilibrium"], capture_output=True, text=True, check=True
    )
    (first,) = re.findall(r"^ +1 +(\S+) +\S+ +body 1 ωy", done.stdout, re.MULTILINE)
    assert f"{float(first):.3f}" == stated(
        "tutorial/finite-element-body.md", r"the first, (\S+) Hz, is the swing"
    )
    assert float(first) == pytest.approx((1.5 * 9.81 / 0.1) ** 0.5 / 6.2831853, rel=0.02)


@pytest.mark.processes
@pytest.mark.parametrize(("step", "digits"), [("0.1", 5), ("0.05", 6)])
def test_a_study_misses_the_peak_between_rows_as_far_as_its_page_says(step, digits, tmp_path):
    """Eleven cranks at 3 to 4 rad/s; the rocker of 3.7 m points upwards in each."""
    (tmp_path / "study.toml").write_text(
        f'deck = "{TOP / "decks/young/IN4-BAR.dat"}"\n[parameters]\n"time.step" = [{step}]\n'
        '"driver.1.B" = { from = 3.0, to = 4.0, count = 11 }\n'
        '[results]\nmax = "max body.3.z"\nhighest = "highest body.3.z"\n'
    )
    subprocess.run([*FLEXMB, "sweep", "study.toml", "-q"], cwd=tmp_path, check=True)
    with h5py.File(tmp_path / "study.h5") as table:
        peaks = [table[f"result/{name}"][:] for name in ("max", "highest")]
    ends = stated(
        "reference/studies.md",
        rf"\b{re.escape(step)}` gives a `max` of (\S+) to (\S+) m and a `highest` of (\S+) to (\S+) m\b",
    )
    assert tuple(f"{end:.{digits}f}" for peak in peaks for end in (peak.min(), peak.max())) == ends


def test_sizes_of_pages_are_those_of_their_files():
    plotly = pytest.importorskip("plotly")
    script = Path(plotly.__file__).parent / "package_data/plotly.min.js"
    megabytes = f"{script.stat().st_size / 1e6:.0f}"  # whole ones: versions differ by a tenth
    assert stated("how-to/curves-and-pages.md", r"which takes about (\S+) MB of each") == megabytes
    assert stated("how-to/pictures.md", r"\| plotly.js \| (\S+) MB") == megabytes
    own = sum(path.stat().st_size for path in VIEWER.iterdir())
    assert round(own / 1000) == int(stated("how-to/pictures.md", r"The viewer is flexmb's own, (\d+) kB"))
