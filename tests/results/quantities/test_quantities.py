"""Readable names of the quantities of a result, and what is read for them."""

import errno
import io
import re
from pathlib import Path

import h5py
import numpy as np
import pytest

from flexmb_cli import solve
from flexmb_cli.results.quantities.quantities import Quantity, ResultError, names, open_result, read, resolve
from flexmb_cli.results.quantities.quantity_names import Family, Slot
from flexmb_cli.results.quantities.readable import readable
from flexmb_cli.results.quantities.unknown_names import hint_for
from tests.results.results import SERIES, value, write_result

DECKS = Path(__file__).resolve().parents[3] / "decks"


@pytest.fixture
def result(tmp_path):
    with open_result(write_result(tmp_path / "r.h5", 7)) as file:
        yield file


def test_a_series_that_somebody_made_text_is_not_passed_over(tmp_path):
    path = write_result(tmp_path / "r.h5", 7)
    with h5py.File(path, "a") as file:
        scale = file["energy/total"].dims[0][0]
        del file["energy/total"]
        file["energy/total"] = ["a"] * 7
        file["energy/total"].dims[0].attach_scale(scale)
    with (
        pytest.raises(ResultError, match="/energy/total has text in place of numbers"),
        open_result(path) as f,
    ):
        names(f)


@pytest.mark.parametrize(
    ("pattern", "headers"),
    [
        ("body.3.z", ["body.3.z [m]"]),
        ("body.3.position.z", ["body.3.z [m]"]),
        ("BODY.Body_3.Z", ["body.3.z [m]"]),
        ("body.2.omega.x", ["body.2.omega.x [rad/s]"]),
        ("body.2.angular_velocity.x", ["body.2.omega.x [rad/s]"]),
        ("body.1.position", ["body.1.x [m]", "body.1.y [m]", "body.1.z [m]"]),
        ("body.1.e0", ["body.1.e0 [1]"]),
        ("body.*.z", ["body.1.z [m]", "body.2.z [m]", "body.3.z [m]"]),
        ("body.[12].velocity.y", ["body.1.velocity.y [m/s]", "body.2.velocity.y [m/s]"]),
        ("point.2.acceleration.x", ["point.2.acceleration.x [m/s2]"]),
        ("point.body 2 node 1.acceleration.x", ["point.2.acceleration.x [m/s2]"]),
        ("coordinate.theta2", ["coordinate.2 [rad]"]),
        ("coordinate.body_2_node_1_axis_3", ["coordinate.5 [m]"]),
        ("coordinate.5.u", ["coordinate.5.u [m/s]"]),
        ("coordinate.theta*", ["coordinate.1 [rad]", "coordinate.2 [rad]"]),
        ("reaction.4.force.z", ["reaction.4.force.z [N]"]),
        ("reaction.closure 1_a.force.z", ["reaction.4.force.z [N]"]),
        ("reaction.revolute 2.force.x", ["reaction.3.force.x [N]"]),
        ("driver.1.effort", ["driver.1.effort [N or N m]"]),
        ("energy.total", ["energy.total [J]"]),
        ("elastic.2.node3.y", ["elastic.2.node3.y [m]"]),
        ("elastic.body 2.3.y", ["elastic.2.node3.y [m]"]),
        ("elastic.2.node3.rate.y", ["elastic.2.node3.rate.y [m/s]"]),
        ("modal.2.amplitude.2", ["modal.2.amplitude.2 [m]"]),
        ("audit", ["audit.newton_iterations [1]"]),
        ("time", ["time [s]"]),
    ],
)
def test_names_mean_what_they_say(result, pattern, headers):
    assert [quantity.header for quantity in resolve(result, [pattern])] == headers


@pytest.mark.parametrize(
    ("pattern", "path", "place"),
    [
        ("body.3.z", "body/position", (2, 2)),
        ("body.2.omega.x", "body/angular_velocity", (1, 0)),
        ("body.3.e3", "body/euler_parameters", (2, 3)),
        ("coordinate.theta2", "coordinate/q", (1,)),
        ("reaction.4.force.y", "reaction/force", (3, 1)),
        ("elastic.2.node3.y", "elastic/body 2/displacement", (1, 1)),
        ("modal.2.amplitude.2", "modal/body 2/amplitude", (1,)),
        ("energy.total", "energy/total", ()),
    ],
)
def test_the_value_is_that_of_the_place(result, pattern, path, place):
    read_values = read(result, resolve(result, [pattern]), slice(1, 6, 2))
    assert read_values.tolist() == [[value(path, row, *place)] for row in (1, 3, 5)]


def test_columns_come_in_the_order_asked_and_once(result):
    quantities = resolve(result, ["energy.total", "body.3.z", "body.1", "body.*.z", "time"])
    order = [quantity.name for quantity in quantities]
    assert order[:2] == ["energy.total", "body.3.z"]
    assert sorted(set(order)) == sorted(order)
    values = read(result, quantities)
    assert values.shape == (7, len(quantities))
    assert values[:, 0].tolist() == [value("energy/total", row) for row in range(7)]
    assert values[:, order.index("body.2.z")].tolist() == [
        value("body/position", row, 1, 2) for row in range(7)
    ]
    assert values[:, -1].tolist() == (0.25 * np.arange(7)).tolist()


def test_motion_is_listed_in_the_order_of_its_derivatives(result):
    order = [quantity.name for quantity in resolve(result, ["body.1"])]
    assert [name for name in order if name.endswith((".x", "0"))] == [
        "body.1.x",
        "body.1.e0",
        "body.1.velocity.x",
        "body.1.omega.x",
    ]


@pytest.mark.long_motion
def test_every_listed_name_names_just_itself(result):
    listed = names(result)
    assert len(listed) == 1 + sum(result[series.path][0].size for series in SERIES)
    for quantity in listed:
        assert resolve(result, [quantity.name]) == [quantity]


def test_meanings_carry_the_names_of_the_deck(result):
    assert resolve(result, ["reaction.3.force.x"])[0].long_name == "revolute 2: force on body J"
    assert resolve(result, ["coordinate.5"])[0].long_name == "body 2 node 1 axis 3: generalized coordinate"


def test_a_body_with_two_rotations_has_no_single_angle(result):
    with pytest.raises(ResultError, match=r"coordinate\.theta3: the result has no such quantity"):
        resolve(result, ["coordinate.theta3"])


@pytest.mark.parametrize(
    ("pattern", "near"),
    [
        ("body.2.omga.x", "body.2.omega.x"),
        ("energy.totl", "energy.total"),
        ("coordinate.theta7", "coordinate.theta1"),
        ("bdy.1.velocity", "body.1.velocity"),
    ],
)
def test_an_unknown_name_is_answered_with_near_ones(result, pattern, near):
    with pytest.raises(ResultError) as caught:
        resolve(result, [pattern])
    assert caught.value.exit_code == 2
    hint = str(caught.value).partition("near it are ")[2].partition(";")[0].split(", ")
    assert near in hint


@pytest.mark.parametrize(
    ("pattern", "hint"),
    [
        ("body.9.z", "it has body 1 to "),
        ("body/position", "names are written with points, such as body.1.x"),
        ("body[2].z", "names are written with points, such as body.2.z"),
        ("stress", "stresses need the cards MATL and OUTS of a VSDF deck"),
        ("velocity", "of which one? names are such as body.1.velocity;"),
    ],
)
def test_a_name_of_what_the_result_lacks_is_answered_with_the_reason(result, pattern, hint):
    with pytest.raises(ResultError, match=re.escape(f"no such quantity; {hint}")):
        resolve(result, [pattern])


def test_a_kinematic_result_names_what_reactions_need_and_a_body_without_joints_what_coordinates_need():
    with pytest.raises(KeyError, match="DYNAMICS inverse or DYNAMICS"):
        solve(DECKS / "young/IN4-BAR.dat")["reactions.1"]
    with pytest.raises(KeyError, match="turns about one axis, or slides along one"):
        solve(DECKS / "young/IN1-1-1.dat")["coordinate"]


def test_all_unknown_names_are_told_at_once(result):
    with pytest.raises(ResultError) as caught:
        resolve(result, ["body.7.z", "time", "qqq"])
    assert [fault.message.split(":")[0] for fault in caught.value.faults] == ["body.7.z", "qqq"]


@pytest.mark.parametrize("pattern", ["", ".", "body..z", "body.1.z.more", "*.*.*.*.*.*"])
def test_patterns_that_fit_nothing_are_refused(result, pattern):
    with pytest.raises(ResultError, match="no such quantity"):
        resolve(result, [pattern])


class CountingFile(io.FileIO):
    """A file that counts the bytes read from it, or is on a disk that `fails`."""

    count = 0
    fails = False

    def readinto(self, buffer):
        if self.fails:
            raise OSError(errno.EIO, "Input/output error")
        got = super().readinto(buffer)
        self.count += got
        return got


def test_only_what_is_asked_for_is_read(tmp_path):
    path = write_result(tmp_path / "big.h5", 20000)
    with CountingFile(path) as disk, h5py.File(disk, "r") as file:
        quantities = resolve(file, ["energy.total"])
        before = disk.count
        read(file, quantities, slice(0, 2000))
        asked = disk.count - before
    # Rows come in chunks of 1024: two of them, and the index of the chunks.
    assert 2000 * 8 <= asked <= 3 * 1024 * 8 + 16384
    assert path.stat().st_size > 20000 * 8 * 60


def test_files_of_other_kinds_are_refused(tmp_path):
    (tmp_path / "letter").write_text("Dear Sir,\n")
    h5py.File(tmp_path / "other.h5", "w").close()
    for name, message in (
        ("none.h5", "no such file"),
        (".", "it is a folder"),
        ("letter", "not an HDF5 result"),
        ("other.h5", "not a result of flexmb: it has no dataset /time"),
    ):
        with pytest.raises(ResultError, match=message) as caught, open_result(tmp_path / name):
            pass
        assert caught.value.exit_code == 2


def test_a_series_that_is_shorter_than_the_time_is_told(tmp_path):
    path = write_result(tmp_path / "r.h5", 40)
    with h5py.File(path, "a") as file:
        file["energy/total"].resize(7, axis=0)
    reported = "r.h5: a damaged result: /energy/total has 7 rows and /time 40; run the deck again"
    with open_result(path) as file, pytest.raises(ResultError, match=reported):
        read(file, resolve(file, ["energy.total"]), slice(0, 5))


def test_a_star_is_everything_and_not_the_time_alone(result):
    assert [q.name for q in resolve(result, ["*"])] == [q.name for q in names(result)][1:]
    assert [q.name for q in resolve(result, ["ti*"])] == ["time"]


def test_a_disk_that_fails_is_told(tmp_path):
    with CountingFile(write_result(tmp_path / "r.h5", 5000)) as disk, h5py.File(disk, "r") as file:
        quantities = resolve(file, ["energy.total"])
        disk.fails = True
        with pytest.raises(ResultError, match="/energy/total cannot be read"):
            read(file, quantities)
        disk.fails = False


@pytest.mark.parametrize("times", [{3: float("nan")}, {39: float("inf")}, {20: 0.0}, {1: 0.0}])
def test_times_that_do_not_ascend_are_told(tmp_path, monkeypatch, times):
    """Rows are found by them; 16 are looked at together, so that 20 and 1 are in two blocks."""
    monkeypatch.setattr("flexmb_cli.results.quantities.quantities.TIMES_AT_ONCE", 16)
    path = write_result(tmp_path / "r.h5", 40)
    with open_result(path):
        pass
    with h5py.File(path, "a") as file:
        for row, time in times.items():
            file["time"][row] = time
    reported = "r.h5: a damaged result: the times of its rows do not ascend, or are not numbers"
    with pytest.raises(ResultError, match=reported), open_result(path):
        pass


def test_a_file_that_is_cut_off_is_named_in_words(tmp_path):
    path = write_result(tmp_path / "r.h5", 7)
    path.write_bytes(path.read_bytes()[:-1000])
    with pytest.raises(ResultError, match="the file is cut off: copy it again") as caught, open_result(path):
        pass
    assert "synchronously" not in str(caught.value)


def test_a_result_without_elements_names_the_card_that_brings_in_those_of_springs():
    """SPRING alone fills no columns of elements."""
    assert "lines such as SPRING or BUSHING" in hint_for("element.1.effort", [])


@pytest.mark.parametrize(
    ("deck", "name", "need"),
    [
        ("dafms/arm_nrot.DAT", "reaction.1.force", "a tree has reactions of closed loops only"),
        ("vsdf/slider_crank_flex.vsdf", "coordinate.1", "need a joint that turns about one axis"),
    ],
)
def test_what_trees_and_vsdf_results_lack_is_said_of_their_own_cards(deck, name, need):
    paths = ["coordinate/u_rate", "energy/strain"] if deck.startswith("dafms") else ["energy/strain"]
    families = [Family(path, (), ((Slot(None, (("x",),)),),), ("1",), "", ()) for path in paths]
    hint = hint_for(name, families)
    assert need in hint
    assert "YOUNG" not in hint


@pytest.fixture
def numbered(tmp_path):
    """A result whose elements and nodes have neighbouring numbers of seven digits."""
    numbers = np.array([1000001, 1000002, 1000016])
    with h5py.File(tmp_path / "r.h5", "w") as file:
        file["time"] = [0.0]
        file["body/name"] = ["body 1", "body 2"]
        file["time"].make_scale("time")
        for kind, path in (
            ("element", "strain/body 2/element_energy"),
            ("node", "stress/body 2/node_von_mises"),
        ):
            file[f"stress/body 2/{kind}"] = numbers
            file[f"stress/body 2/{kind}"].make_scale(kind)
            file[path] = [[1.0, 2.0, 16.0]]
            for dim, scale in zip(
                file[path].dims, (file["time"], file[f"stress/body 2/{kind}"]), strict=True
            ):
                dim.attach_scale(scale)
    return tmp_path / "r.h5"


@pytest.mark.parametrize("pattern, ends", [
    ("strain.2.*.energy", "strain.2.element{}.energy"), ("stress.2.*.von_mises", "stress.2.node{}.von_mises"),
])  # fmt: skip
def test_numbers_of_seven_digits_are_names_of_their_own(numbered, pattern, ends):
    """Six digits made 1e+06 of two neighbours."""
    with open_result(numbered) as file:
        assert [one.name for one in resolve(file, [pattern])] == [
            ends.format(n) for n in (1000001, 1000002, 1000016)
        ]
        (one,) = resolve(file, [ends.format(1000002)])
        assert read(file, [one]).tolist() == [[2.0]]


def test_what_a_flexible_body_has_in_place_of_displacements_is_named(tmp_path):
    """The message said that displacements need a flexible body, which body 2 is."""
    path = write_result(tmp_path / "r.h5", 2)
    with h5py.File(path, "r+") as file:
        del file["elastic/body 2/displacement"], file["elastic/body 2/rate"]
    with pytest.raises(ResultError) as caught, open_result(path) as file:
        resolve(file, ["elastic.2.node43.x"])
    assert "this result has modal.2.amplitude, the amplitudes of modes" in str(caught.value)
    assert "need a flexible body" not in str(caught.value)


def test_the_node_of_the_largest_stress_is_called_so():
    """Its axis read "largest node of body 2"."""
    node = Quantity("stress.2.max.node", "1", "number of that node", "stress/body 2/max_node", ())
    assert readable(node).label == "node of the largest von Mises stress of body 2"
    strain = Quantity("strain.2.node43.principal.1", "1", "", "strain/body 2/node_principal", (0, 0))
    assert readable(strain).label == "principal strain 1 of body 2 node 43"
