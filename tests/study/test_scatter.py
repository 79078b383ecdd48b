"""Scatter of results by tolerances against the closed form of a slider crank."""

import json

import h5py
import numpy as np
import pytest

from tests.study.sensitivity_decks import SLIDER_CRANK
from tests.study.studies import flexmb
from tests.study.test_sensitivity import complex_step, slider

STUDY = """deck = "IN-SLIDER.dat"
sampling = "latin-hypercube"
count = 40
[parameters]
crank = { value = 1, tolerance = 0.01 }
rod = { value = 3, tolerance = 0.03 }
speed = 2
[results]
end = "last body.4.x"
v = "last body.4.velocity.x"
"""


@pytest.fixture
def study(tmp_path):
    (tmp_path / "IN-SLIDER.dat").write_text(SLIDER_CRANK)
    (tmp_path / "study.toml").write_text(STUDY)
    return tmp_path


def test_scatter_is_that_of_the_closed_form_of_a_slider_crank(study):
    """By complex steps of the closed form, and of its values at the places of the sample; σ_p is d/√3."""
    printed = flexmb("sweep", "study.toml", cwd=study).stdout.splitlines()
    t = np.array([2.0])
    slopes = complex_step(slider, [1.0, 3.0, 0.5, 2.0], t)[0, :2, :2]
    parts = (slopes * np.array([0.01, 0.03]) / np.sqrt(3.0)) ** 2
    with h5py.File(study / "study.h5") as table:
        group = table["scatter"]
        assert group["number"].asstr()[:].tolist() == ["crank", "rod"]
        crank, rod = (table[f"parameter/{name}"][:] for name in ("crank", "rod"))
        sample = np.concatenate([slider(a, b, 0.5, 2.0, t)[:, :2] for a, b in zip(crank, rod, strict=True)])
        assert group["derivatives"][:] == pytest.approx(slopes, abs=1e-9)
        assert group["linear"][:] == pytest.approx(np.sqrt(parts.sum(axis=1)), rel=1e-9)
        assert group["sampled"][:] == pytest.approx(sample.std(axis=0, ddof=1), rel=1e-9)
        assert group["nominal"][:] == pytest.approx(slider(1.0, 3.0, 0.5, 2.0, t)[0, :2], rel=1e-12)
        # A linear estimate and a sample of forty agree to the error of the sample.
        assert group["sampled"][:] == pytest.approx(group["linear"][:], rel=0.1)
        shares = group["shares"][:]
    assert shares == pytest.approx(parts / parts.sum(axis=1, keepdims=True), rel=1e-8)
    first, share = sorted(zip(("crank", "rod"), shares[0], strict=True), key=lambda pair: -pair[1])[0]
    assert printed[0].startswith("end = ") and f"of the sample; {first} {share:.1%}" in printed[0]


def test_the_command_gives_a_record_a_picture_and_a_page(study):
    record = json.loads(flexmb("sweep", "study.toml", "--json", cwd=study).stdout)
    assert [one["result"] for one in record["scatter"]] == ["end", "v"]
    assert sum(record["scatter"][1]["shares"].values()) == pytest.approx(1.0)
    flexmb("plot", "study.h5", "--kind", "tolerances", "-o", "s.svg", cwd=study)
    assert "share of" in (study / "s.svg").read_text()
    flexmb("report", "study.h5", "-o", "s.html", cwd=study)
    assert "<h2>Scatter by tolerances</h2>" in (study / "s.html").read_text()


@pytest.mark.parametrize(
    ("old", "new", "identifier"),
    [
        ("tolerance = 0.01", "tolerance = 0", "STUDY-140"),
        ("value = 1, tolerance = 0.01", "value = 1, from = 0, tolerance = 0.01", "STUDY-140"),
        ('sampling = "latin-hypercube"\ncount = 40', "", "STUDY-140"),
    ],
)
def test_wrong_tolerances_have_a_place(old, new, identifier, study):
    (study / "study.toml").write_text(STUDY.replace(old, new))
    ended = flexmb("sweep", "study.toml", "--json", cwd=study, check=False)
    [fault, *_] = json.loads(ended.stdout)["faults"]
    assert (ended.returncode, fault["id"], fault["object"]) == (2, identifier, "crank")


def test_a_middle_that_cannot_be_solved_leaves_the_table_without_scatter(study):
    text = STUDY.replace("value = 3, tolerance = 0.03", "value = 0.9, tolerance = 0.6")
    (study / "study.toml").write_text(text)
    ended = flexmb("sweep", "study.toml", cwd=study, check=False)
    assert ended.returncode == 1 and "no scatter: in the middle of the ranges" in ended.stderr
    assert (study / "study.h5").exists()
