"""Decks that say their units, and `--units`: the same machine in SI units and in millimetres and tonnes.

Physics does not depend on units: a deck of which every number was converted must give the same motion,
forces and stresses, once --units shows both in one unit.
"""

import json
import re
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.deck.units import TABLE, UNITS, converted, declared, with_prefix

DECKS = Path(__file__).resolve().parents[3] / "decks"

BLOCK = "ELEMENTS\n  UNITS mm\n"


def flexmb(*arguments):
    return CliRunner().invoke(cli, [str(argument) for argument in arguments])


def columns(result, names, units):
    done = flexmb("table", result, *names, "--units", units, "--json")
    assert done.exit_code == 0, done.output
    rows = json.loads(done.stdout)["rows"]
    return {head: np.array([row[head] for row in rows]) for head in rows[0]}


def assert_alike(first, second, rtol):
    for (head, one), (other_head, other) in zip(first.items(), second.items(), strict=True):
        assert head.partition(" ")[2] == other_head.partition(" ")[2]
        assert np.allclose(one, other, rtol=0, atol=rtol * (np.abs(one).max() or 1e-6)), head


def test_a_young_deck_in_millimetres_gives_the_motion_of_its_deck_in_si_units(tmp_path, monkeypatch):
    """The conversion of `convert` writes every number anew; the units come from the deck's own line."""
    monkeypatch.chdir(tmp_path)
    deck = DECKS / "young/dynamics/IN-CAM.dat"
    assert flexmb("convert", deck, "--to", "young", "--to-unit", "mm", "-o", "INMM.dat").exit_code == 0
    for one in (deck, "INMM.dat"):
        done = flexmb("run", one)
        assert done.exit_code == 0, done.output
        assert "SI units" not in done.output  # gravity of 9810 is that of millimetres
    with h5py.File("OUTMM.h5") as result:
        assert result.attrs["units"] == "mm"
        assert result["body/position"].attrs["units"] == "mm"
        assert result["energy/kinetic"].attrs["units"] == "mJ"
        units = result["element/effort"].attrs["units"]
        assert set(units.split(" or ")) <= {"N mm", "N"}
    # The conversion drops the body that is the ground, and writes couplings in another order.
    named = [("body.3.z", "body.2.z"), ("body.4.z", "body.3.z"), ("body.2.omega.z", "body.1.omega.z")]
    named += [(name, name) for name in ("element.back.effort", "energy.kinetic", "coordinate")]
    si = columns("OUT-CAM.h5", [name for name, _ in named], "mm,deg,N,mJ")
    own = columns("OUTMM.h5", [name for _, name in named], "mm,deg,N,mJ")
    assert "body.2.z [mm]" in own and "body.1.omega.z [deg/s]" in own and "energy.kinetic [mJ]" in own
    assert_alike(si, own, 1e-7)  # both solved to a relative tolerance of 1e-10


def in_millimetres(source, target):
    """Write the rod of a slider-crank, in SI units at `source`, in millimetres, tonnes and megapascals."""
    shutil.copytree(DECKS / "vsdf/fe/rod", target / "fe/rod")
    mesh = target / "fe/rod/rod.inp"
    node = re.compile(r"^(\d+), ([-\d.e+]+), ([-\d.e+]+), ([-\d.e+]+)$", re.MULTILINE)
    head, mark, rest = mesh.read_text().partition("*ELEMENT")
    mesh.write_text(
        node.sub(lambda m: ", ".join([m[1], *(repr(1e3 * float(x)) for x in m.groups()[1:])]), head)
        + mark
        + rest
    )
    for suffix in ("mas", "sti"):  # kg to t, N/m to N/mm
        path = target / f"fe/rod/rod.{suffix}"
        entries = (line.split() for line in path.read_text().splitlines())
        path.write_text("".join(f"{i} {j} {float(value) / 1e3!r}\n" for i, j, value in entries))
    text = source.read_text()
    text = text.replace("TIME\n", f"{BLOCK}TIME\n", 1)
    shapes, rest = text.index("GEOM\n"), text.index("MATL\n")
    text = text[:shapes] + text[rest:]  # pictures only
    for old, new in (
        ("1       0.5     0.075", "1    5.0E-4      75.0"),
        ("1.0E-3    1.0E-3    1.0E-3\n    3", "1.0       1.0       1.0\n    3"),
        ("3       1.0\n    1.0E-3    1.0E-3    1.0E-3", "3    1.0E-3\n       1.0       1.0       1.0"),
        (" 0.15    -0.005     -0.01\n    3      0.65", "150.0      -5.0     -10.0\n    3     650.0"),
        ("    1    2       0.0       0.0       0.1", "    1    2       0.0       0.0     100.0"),
        ("    1    3      0.15", "    1    3     150.0"),
        ("    1    4      0.15       0.0       0.1", "    1    4     150.0       0.0     100.0"),
        ("    3    2       0.1", "    3    2     100.0"),
        ("    3    3       0.0       0.1", "    3    3       0.0     100.0"),
        ("2.1E11       0.3    7850.0", "2.1E05       0.3  7.850E-9"),
    ):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    (target / "rod_mm.vsdf").write_text(text)


@pytest.mark.long_motion
def test_a_finite_element_body_of_millimetres_has_stresses_in_megapascals(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    deck = DECKS / "vsdf/slider_crank_stress.vsdf"
    in_millimetres(deck, tmp_path)
    for one in (deck, "rod_mm.vsdf"):
        done = flexmb("run", one)
        assert done.exit_code == 0, done.output
        assert "kg/m³" not in done.output
    listed = flexmb("table", "rod_mm.h5", "--list", "stress.2.max.von_mises").stdout
    assert listed.split()[:2] == ["stress.2.max.von_mises", "MPa"]
    names = ["stress.2.max.von_mises", "body.3.x", "reaction.4.force.y", "energy.strain"]
    si = columns("slider_crank_stress.h5", names, "mm,MPa,kN")
    own = columns("rod_mm.h5", names, "mm,MPa,kN,J")
    assert_alike(si, own, 1e-5)  # matrices of the files have 14 digits; the rod's modes amplify them
    page = flexmb("report", "rod_mm.h5", "-o", "-").stdout
    assert '"unit":"MPa","factor":1.0' in page
    page = flexmb("report", "slider_crank_stress.h5", "-o", "-").stdout
    assert '"unit":"MPa","factor":1e-06' in page  # 1.2e7 Pa are 12 MPa


def test_units_that_a_deck_cannot_have_are_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (DECKS / "young/dynamics/IN-CAM.dat").read_text()
    for line, words in (
        ("UNITS yard", "UNITS is followed by one of m, mm, mm-kg, cm, in; read 'yard'"),
        ("UNITS mm\n  UNITS cm", "the deck has said its units already"),
    ):
        (tmp_path / "IN.dat").write_text(text.replace("ELEMENTS\n", f"ELEMENTS\n  {line}\n", 1))
        done = flexmb("check", "IN.dat")
        assert done.exit_code == 2 and words in done.output
    (tmp_path / "IN.dat").write_text(text.replace("ELEMENTS\n", "ELEMENTS\n  UNITS mm\n", 1))
    for more, words in (
        (("--to", "exudyn"), "convert it to a deck in SI units first"),
        (("--to", "vsdf", "--unit", "cm"), "the deck says UNITS mm"),
    ):
        done = flexmb("convert", "IN.dat", *more)
        assert done.exit_code and words in str(done.exception)
    for more, words in (
        (("table", "r.h5", "body", "--units", "furlong"), "there is no unit 'furlong'"),
        (("table", "r.h5", "body", "--units", "mm,cm"), "mm and cm are units of one quantity"),
        (("export", "r.h5", "--to", "mat", "--units", "mm"), "--units is for csv"),
    ):
        done = flexmb(*more)
        assert done.exit_code == 2 and words in " ".join(done.output.replace("│", " ").split())


def test_sizes_of_units_are_those_of_the_books():
    """NIST SP 811, appendix B: 1 psi = 6894.757 Pa, 1 lbf in = 0.1129848 N m, 1 dyn = 1e-5 N."""
    assert TABLE["psi"].factor == pytest.approx(6894.757, rel=1e-7)
    assert converted("lbf in", {"m": "m", "N": "N"}) == ("N m", pytest.approx(0.1129848, rel=1e-6))
    assert declared("J", UNITS["in"]) == "lbf in"
    assert [declared("Pa", UNITS[name]) for name in UNITS] == ["Pa", "MPa", "kPa", "barye", "psi"]
    assert converted("m/s2", {"m": "ft"}) == ("ft/s2", pytest.approx(1 / 0.3048))
    assert converted("rad/s", {"rad/s": "rpm"}) == ("rpm", pytest.approx(60 / (2 * np.pi)))
    assert converted("N m/rad", {"N": "kN", "rad": "deg"}) == ("kN m/deg", pytest.approx(1e-3 * np.pi / 180))
    assert converted("s", {"s": "ms"}) == ("ms", 1e3) and converted("m/s", {"s": "ms"}) == ("m/s", 1.0)


@pytest.mark.parametrize(
    ("unit", "largest", "shown"),
    [
        ("Pa", 1.2e7, "MPa"), ("N", 999.0, "N"), ("N", 1000.0, "kN"), ("N m", 0.02, "mN m"), ("J", 0.0, "J"),
        ("J", 1e-12, "J"), ("m", 0.0099, "mm"), ("m", 0.01, "m"), ("m/s", 1e-4, "m/s"), ("rad", 5.0, "rad"),
    ],
)  # fmt: skip
def test_labels_have_the_prefix_of_one_to_three_digits(unit, largest, shown):
    found, factor = with_prefix(unit, largest)
    assert found == shown
    if factor != 1.0:
        assert 1.0 <= largest * factor * (1 + 1e-9) < 1000.0 * (1 + 1e-9)
