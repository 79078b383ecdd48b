"""What results of VSDF and DAFMS decks hold of their elements: names, default curves, power and energy."""

import h5py
import numpy as np
import pytest

from flexmb_cli.results.figures.curves import default_curves
from flexmb_cli.results.quantities.quantities import names, resolve
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck
from tests.dialects.dafms.test_dafms_elements import TWO_LINKS, deck, function
from tests.dialects.dafms.test_every_card import joined
from tests.dialects.vsdf.test_elements import TWO_LINKS as VSDF_LINKS

pytestmark = pytest.mark.long_motion
# Two links: the first driven by a sine, springs and friction at both hinges, a stop and a line spring.
DRIVER = [function(1, "sine", 0, 0.6, 3), "ELEMENTS\n  DRIVE pref-1 at=1.r3 value=1"]
SECOND = [function(2, "sine", 0.6, 0.6, 3, -1.5707963268), "ELEMENTS\n  DRIVE pref-2 at=2.r3 value=2"]
ELEMENTS = [
    "ELEMENTS\n  SPRING hspr-1 at=2.r3 stiffness=3 rest=1 damping=0.05",
    "ELEMENTS\n  SPRING lspr-1 from=0(1,2,0) to=2(0.6,0,0) stiffness=30 rest=1.2 damping=0.5 preload=2",
    "ELEMENTS\n  STOP hsto-1 at=2.r3 lower=-0.1 upper=0.1 stiffness=200 damping=0.1",
    "ELEMENTS\n"
    "  FRICTION fric-1 joint=1 dynamic=0.1 static=0.12 stribeck=0.1 creep=0.01 "
    "radius=0.02 preload=1",
]
LINKS = TWO_LINKS.replace("    5\n       0.1\n", "  400\n     0.001\n")
DAFMS = deck(joined(DRIVER, ELEMENTS), LINKS)
VSDF = (
    f"{VSDF_LINKS}ELEMENTS\n"
    "  FUNCTION 1 sine 0 0.6 3\n"
    "MOTN\n"
    " 1,ANGL,1,5,1\n"
    "ELEMENTS\n"
    "  SPRING tspr-1 at=2.angle stiffness=3 rest=1 damping=0.05\n"
    "ELEMENTS\n"
    "  SPRING lspr-1 from=0:3 to=2:3 stiffness=30 rest=1.2 damping=0.5 preload=2\n"
    "  STOP tsto-1 at=2.angle lower=-0.1 upper=0.1 stiffness=200 damping=0.1\n"
    "  FRICTION fric-1 joint=1 dynamic=0.1 static=0.12 stribeck=0.1 creep=0.01 "
    "radius=0.02 preload=1\n"
    "INTG\n"
    " RK45\n"
    "TIME\n"
    " 0.4,0.001\n"
    "END\n"
    "STAR\nSTOP\n"
)
# In the order of results: name, unit of the coordinate, of the effort.
WANTED = {"DAFMS": ("hspr-1", "lspr-1", "hsto-1", "fric-1"), "VSDF": ("tspr-1", "lspr-1", "tsto-1", "fric-1")}
TEXTS = {"DAFMS": DAFMS, "VSDF": VSDF}


@pytest.fixture(params=TEXTS)
def result(request, tmp_path):
    path = tmp_path / f"x.{'DAT' if request.param == 'DAFMS' else 'vsdf'}"
    path.write_text(TEXTS[request.param])
    outcome = run_deck(str(path), RunOptions(folder=str(tmp_path)))
    assert (outcome.exit_code, outcome.faults) == (0, [])
    with h5py.File(tmp_path / "x.h5") as file:
        yield request.param, file


def integral(values, times):
    """Simpson's rule over all rows."""
    h = times[1] - times[0]
    return h / 3 * (values[0:-2:2] + 4 * values[1:-1:2] + values[2::2]).sum()


def test_elements_have_names_and_units_curves_and_an_energy_that_adds_up(result):
    """The work of all other loads is that of the driver, and what dampers and friction take."""
    dialect, file = result
    found = [text.decode() for text in file["element/name"][:]]
    assert tuple(found) == WANTED[dialect]
    assert [text.decode() for text in file["element/unit"][:]] == ["rad", "m", "rad", "m"]
    by_name = {one.name: one for one in names(file)}
    for k, (name, unit) in enumerate(zip(found, ("N m", "N", "N m", "N"), strict=True), 1):
        assert by_name[f"element.{name}.effort"].unit == unit
        assert {f"element.{name}.{what}" for what in ("coordinate", "rate", "power")} <= set(by_name)
        assert resolve(file, [f"element.{k}.effort"]) == [by_name[f"element.{name}.effort"]]
    drawn = {one.dataset for one in default_curves(file).quantities}
    assert drawn >= {"coordinate/q", "element/effort", "driver/effort"}
    assert set((file["element/effort"][:, 2] == 0.0).tolist()) == {True, False}
    power = file["driver/effort"][:, 0] * file["coordinate/u"][:, 0] + file["element/power"][:].sum(axis=1)
    work = file["energy/applied_work"]
    assert integral(power, file["time"][:]) == pytest.approx(work[-1] - work[0], rel=1e-4)
    assert np.ptp(file["energy/total"]) < 1e-7 * np.max(file["energy/kinetic"])
    taken = [integral(power, file["time"][:]) for power in file["element/power"][:].T]
    assert file["element/work"][-1] == pytest.approx(taken, rel=1e-3)
    assert file["energy/dissipated"][-1] == pytest.approx(-sum(taken), rel=1e-4)
    assert {"element.fric-1.work", "energy.dissipated"} <= set(by_name)


def test_the_work_of_a_stop_is_found_where_nothing_is_free_to_move(tmp_path):
    """Both hinges driven: the motion has no error, but steps of a tenth of a second step over the stop."""
    path = tmp_path / "x.DAT"
    path.write_text(deck(joined(DRIVER, SECOND, ELEMENTS), LINKS))
    outcome = run_deck(str(path), RunOptions(folder=str(tmp_path)))
    assert outcome.exit_code == 0
    with h5py.File(tmp_path / "x.h5") as file:
        power = (file["driver/effort"][:] * file["coordinate/u"][:]).sum(axis=1)
        power += file["element/power"][:].sum(axis=1)
        work = file["energy/applied_work"]
        assert integral(power, file["time"][:]) == pytest.approx(work[-1] - work[0], abs=1e-5)
        assert np.ptp(file["energy/total"]) < 1e-5


def test_composite_joints_and_couplings_have_forces_with_names_and_units(tmp_path):
    """A hanging rack of 2 kg that a held pinion carries by 2 g; a ball of 3 kg on a link of 1 m."""
    (tmp_path / "INX.dat").write_text(
        "4 0 0 0 0 1 0 1 0 0 0 1\n" + 3 * "0 0 0 1 0 0 0\n" + "0 0 -1 1 0 0 0\n"
        "1 2 0 0 0 0 0 0 0 0 1 0 0 1\n1 3 0 0 0 0 0 0 0 0 1 0 0 1 1 0 0 0 1 0\n1 0 0 0 0 0 0\n0 1 0.5\n"
        "DYNAMICS forward\nMASS 2 1 0 0 0 1 1 1\nMASS 3 2 0 0 0 1 1 1\nMASS 4 3 0 0 0 1 1 1\n"
        "GRAVITY 0 0 -10\n"
        "ELEMENTS\n"
        "  FUNCTION 1 polynomial 0\n"
        "  DRIVE angle-1 at=1.angle value=1\n"
        "  COUPLING coupling-1 1.angle=-0.2 2.stroke=1\n"
        "ELEMENTS\n  JOINT sphsph-1 sphsph from=0(0,0,0) to=4(0,0,0) length=1\nEND\n"
    )
    assert run_deck(str(tmp_path / "INX.dat"), RunOptions(folder=str(tmp_path))).exit_code == 0
    with h5py.File(tmp_path / "OUTX.h5") as file:
        by_name = {one.name: one for one in names(file)}
        assert by_name["coupling.coupling-1.effort"].unit == "N"
        assert file["coupling/effort"][:, 0] == pytest.approx(np.full(3, 20.0), rel=1e-12)
        units = [by_name[f"composite.sphsph-1.{what}"].unit for what in ("force.z", "torque.x")]
        assert units == ["N", "N m"]
        assert file["composite/name"][0] == b"sphsph-1" and file["coupling/name"][0] == b"coupling-1"
        assert file["composite/force"][-1, 0] == pytest.approx((0, 0, 30.0), abs=1e-9)
