"""Cards RBE2, RBE3 and FEMD of VSDF decks: nodes carried, and means of nodes; viscous damping of a file.

Expected: the node set of the same nodes, the same forces at the nodes themselves, and damping proportional to
the stiffness by DAMP; impulse and moment of inertia of a rod on a hinge, and a pair of forces for a moment.
"""

import h5py
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.io import mmread, mmwrite

from flexmb_cli.cli.run import run
from flexmb_cli.errors import DeckError
from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.interface import read_deck, solve
from tests.dialects.vsdf.vsdf_decks import DECKS, build, supplied

# The free end of the pendulum, its middle, and a corner of it.
END, CENTRE, CORNER = (49, 50, 51, 52, 53, 54), (0.1, 0.005, 0.0075), 49
RBE3 = "RBE3\n    1  901   49   50   51   52   53   54\n"


def with_cards(cards, outputs="901", name="pendulum"):
    text = supplied(name, ("GRAV\n", f"{cards}GRAV\n"), ("    1   51\n", f"    1  {outputs}\n"))
    return text.replace("fe/", f"{DECKS}/fe/").replace("       0.5    5.0E-4", "      0.02     0.002")


def points(text):
    found, _ = flexible_mechanism(build(text), cached=False)
    return found.outputs


def test_a_mean_of_equal_weights_is_at_the_place_of_the_node_set():
    """Sets of today are the special case without rotation."""
    sets = "NSET\n    1  900   49   50   51   52   53   54\n"
    mean, of_set = points(with_cards(sets + RBE3, "901  900"))
    np.testing.assert_allclose(mean.r0, of_set.r0, rtol=0, atol=1e-15)
    np.testing.assert_allclose(mean.shape, of_set.shape, rtol=0, atol=1e-9 * np.abs(of_set.shape).max())


def test_couplings_of_the_file_have_weights_and_the_place_of_their_node(tmp_path):
    """A node table of GRIDs with RBE3: node 901 lies 0.02 m before the end, which turns it."""
    rows = [line.split() for line in (DECKS / "fe" / "pendulum_nodes.txt").read_text().splitlines()]
    grids = "".join(f"GRID,{n},,{x},{y},{z}\n" for n, x, y, z in (row for row in rows if row[0].isdecimal()))
    coupled = "GRID,901,,0.12,.005,.0075\nRBE3,1,,901,123456,1.0,123,49,50\n,51,52,53,54\n"
    (tmp_path / "n.bdf").write_text(grids + coupled)
    cards = "RBE3\n    1  901    0\n"
    text = with_cards(cards).replace(f"TXT  {DECKS}/fe/pendulum_nodes.txt", f"BDF  {tmp_path}/n.bdf")
    (point,) = points(text)
    body = flexible_mechanism(build(text), cached=False)[0].bodies[0].reduced
    np.testing.assert_allclose(body.axes @ point.r0 + body.origin, (0.12, 0.005, 0.0075), rtol=0, atol=1e-14)
    moved = np.stack([body.shape(node) for node in END])
    arms = np.stack([body.position(node) for node in END]) - np.mean([body.position(n) for n in END], axis=0)
    # Least squares of numpy, mode by mode: rotation of the end, about its middle.
    crossed = np.vstack([np.cross(np.eye(3), arm).T for arm in arms])
    centre = moved.mean(axis=0)
    turn = np.linalg.lstsq(crossed, (moved - centre).reshape(18, -1), rcond=None)[0]
    expected = centre + np.cross(turn.T, point.r0 - np.mean([body.position(n) for n in END], axis=0)).T
    np.testing.assert_allclose(point.shape, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


def rows_of(folder, name, text):
    """Positions and velocities over time of the deck's node."""
    path = folder / f"{name}.vsdf"
    path.write_text(text)
    done = CliRunner().invoke(run, [str(path), "-o", str(folder), "-q"])
    assert done.exit_code == 0, done.output
    with h5py.File(folder / f"{name}.h5") as file:
        return file["point/position"][:], file["point/velocity"][:]


@pytest.mark.long_motion
def test_a_force_on_the_mean_is_that_on_its_nodes_in_parts(tmp_path):
    one = "FORC\n    1  901       0.6       3.0      -1.2\n"
    parts = "FORC\n" + "".join(f"    1   {n}       0.1       0.5      -0.2\n" for n in END)
    ours, expected = (
        rows_of(tmp_path, name, with_cards(RBE3 + cards, "51")) for name, cards in (("a", one), ("b", parts))
    )
    for found, wanted in zip(ours, expected, strict=True):
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-9 * np.abs(wanted).max())


@pytest.mark.long_motion
def test_damping_of_a_file_acts_like_that_proportional_to_the_stiffness(tmp_path):
    """B = 2e-4 s times K."""
    B = mmread(DECKS / "fe" / "pendulum_K.mtx") * 2e-4
    mmwrite(tmp_path / "B.mtx", B, precision=17)
    files = {"a": f"FEMD\n    1 MM   {tmp_path}/B.mtx\n", "b": "DAMP\n    1       0.0    2.0E-4\n", "c": ""}
    ours, expected, undamped = (
        rows_of(tmp_path, name, with_cards(cards, "51"))[1] for name, cards in files.items()
    )
    np.testing.assert_allclose(ours, expected, rtol=0, atol=1e-7 * np.abs(expected).max())
    assert np.abs(undamped - expected).max() > 1e-3 * np.abs(expected).max()


REFUSED = {
    "the number of a set": ("NSET\n    1  901   49   50\n" + RBE3, "901 is a node set of body 1"),
    "a node twice": (RBE3.replace("54\n", "49\n"), "node 49 of body 1 is coupled twice"),
    "itself": (RBE3.replace(" 901", "  49"), "node 49 of body 1 is coupled twice, or to itself"),
    "two cards": (RBE3 + "    1  901    1    2    3\n", "901 of body 1 is carried by another, or"),
    "nodes on a line": ("RBE3\n    1  901    1    7   13\n", "lie on one line, or at one place"),
    "a node that is not there": (RBE3.replace("54\n", "94\n"), "body 1 has no node 94"),
    "a file without couplings": ("RBE3\n    1  901    0\n", "files of format TXT have no couplings"),
    "damping to ground": ("FEMD\n    1 MM   fe/pendulum_M.mtx\n", "matrix resists rigid motion"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_cards_that_cannot_be_used_are_refused(case, tmp_path):
    cards, words = REFUSED[case]
    path = tmp_path / "x.vsdf"
    path.write_text(with_cards(cards, "51"))
    done = CliRunner().invoke(run, [str(path), "-o", str(tmp_path)])
    assert done.exit_code == 2
    assert words in done.output


def hinge(*cards, end="0.3,0.005"):
    """The supplied deck with other cards of loads."""
    text = supplied("hinge_moment", ("0.3,0.005", end)).replace("fe/", f"{DECKS}/fe/")
    first, last = text.index("TORQ\n"), text.index("OUTN\n")
    return solve(read_deck(text[:first] + "".join(cards) + text[last:]))


MOMENT = "TORQ\n    1,0.0,-2e-3,0.0,0,1,901\n"
LOAD = "FORC\n    1,903,0.0,0.02,0.0,0,1\n"


@pytest.mark.long_motion
def test_a_moment_on_a_rigid_hinge_is_a_pair_of_forces_on_the_nodes_that_it_carries():
    """Nodes 1 and 2 are 0.015 m apart along z; the pair turns by the hinge's 6e-3 rad against the frame."""
    pair = "    1,1,0.13333333333333333,0.0,0.0,1,1\n    1,2,-0.13333333333333333,0.0,0.0,1,1\n"
    ours, expected = hinge(MOMENT, LOAD), hinge(LOAD, pair)
    for name in (f"point.{point}.{axis}" for point in (2, 3) for axis in "xyz"):
        assert ours[name] == pytest.approx(expected[name], abs=1e-7), name
    assert np.ptp(ours["point.3.z"]) > 4e-3 and np.ptp(ours["point.3.y"]) > 1e-3


@pytest.mark.long_motion
def test_the_impulse_of_a_moment_turns_the_rod_about_its_hinge():
    """M t / 2 = 2e-4 N m s, J = m (L²/3 + h²/12) of the rod of 0.26 kg, 0.1 x 0.015 m about its end."""
    result = hinge(MOMENT, end="2.2,0.02")
    later = result["time"] > 0.2
    angle = np.arctan2(result["point.3.z"] - 0.0075, result["point.3.x"])
    rate = np.polyfit(result["time"][later], angle[later], 1)[0]
    assert rate == pytest.approx(2e-4 / (0.26 * (0.1**2 / 3 + 0.015**2 / 12)), rel=1e-4)


def test_what_an_interface_node_carries_stands_in_no_set_and_no_frame():
    for cards in ("CLMP\n    1,1,49,50\n", "NSET\n    1,900,1,49\n", "RBE3\n    1,904,1,49,50\n"):
        with pytest.raises(DeckError, match="node 1 has no rows of its own, since interface node 901"):
            build(supplied("hinge_moment", ("ARMN\n", f"{cards}ARMN\n")))
