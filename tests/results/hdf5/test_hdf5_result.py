"""The HDF5 result: its layout, its bytes, and other programs' reading of it."""

import hashlib
import os
import subprocess
import sys
import textwrap
import time
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from flexmb_cli import __version__
from flexmb_cli.errors import OutputError
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.results.hdf5.kinematic import kinematic_layout, kinematic_values
from flexmb_cli.results.hdf5.result_file import ResultFile, chunk_rows

SHAPES = {
    "time": (),
    "body/position": (2, 3),
    "body/euler_parameters": (2, 4),
    "body/velocity": (2, 3),
    "body/acceleration": (2, 3),
    "body/euler_parameter_rates": (2, 4),
    "body/euler_parameter_accelerations": (2, 4),
    "body/angular_velocity": (2, 3),
    "body/angular_acceleration": (2, 3),
    "point/position": (1, 3),
    "point/velocity": (1, 3),
    "point/acceleration": (1, 3),
    "audit/constraint_residual": (),
    "audit/velocity_residual": (),
    "audit/newton_iterations": (),
}
UNITS = {
    "time": "s",
    "body/position": "m",
    "body/euler_parameters": "1",
    "body/velocity": "m/s",
    "body/acceleration": "m/s2",
    "body/angular_velocity": "rad/s",
    "body/angular_acceleration": "rad/s2",
    "point/acceleration": "m/s2",
    "audit/newton_iterations": "1",
}


@pytest.fixture
def written(tmp_path, deck, mechanism):
    """Write blocks of rows; give the path."""

    def write(*blocks, status="complete", message="", mechanism=mechanism, name="OUT2-1-1.h5"):
        result = ResultFile(tmp_path / name, deck, kinematic_layout(mechanism))
        for block in blocks:
            result.rows(kinematic_values(block))
        result.close(status, message)
        return tmp_path / name

    return write


def datasets(file):
    found = {}
    file.visititems(lambda name, item: found.update({name: item}) if isinstance(item, h5py.Dataset) else None)
    return found


def test_every_dataset_of_the_layout_has_its_shape_and_type(written, rows):
    with h5py.File(written(rows(np.arange(7.0)))) as file:
        for path, shape in SHAPES.items():
            assert file[path].shape == (7, *shape)
            assert file[path].dtype == np.float64


def test_values_come_back_bit_for_bit(written, rows):
    block = rows(np.arange(7.0))
    with h5py.File(written(block)) as file:
        assert np.array_equal(file["body/velocity"], block.velocity)
        assert np.array_equal(file["body/euler_parameter_accelerations"], block.euler_parameter_accelerations)
        assert np.array_equal(file["point/acceleration"], block.point_acceleration)
        assert np.array_equal(file["audit/newton_iterations"], block.newton_iterations)


def test_every_axis_has_a_named_scale(written, rows):
    with h5py.File(written(rows([0.0]))) as file:
        for path, dataset in datasets(file).items():
            for axis in dataset.dims:
                assert dataset.is_scale or len(axis) == 1, path
        axes = [axis[0].name for axis in file["body/euler_parameters"].dims]
        assert axes == ["/time", "/body/body", "/euler_parameter"]
        assert list(file["xyz"].asstr()) == ["x", "y", "z"]
        assert list(file["body/body"]) == [1, 2]


def test_every_dataset_tells_its_unit_and_meaning(written, rows):
    with h5py.File(written(rows([0.0]))) as file:
        found = datasets(file)
        assert all(dataset.attrs["units"] and dataset.attrs["long_name"] for dataset in found.values())
        assert {path: found[path].attrs["units"] for path in UNITS} == UNITS


def test_names_stand_in_the_order_of_the_deck(written, rows):
    with h5py.File(written(rows([0.0]))) as file:
        names = {kind: list(file[f"{kind}/name"].asstr()) for kind in ("body", "point", "joint", "driver")}
    expected = {"body": ["body 1", "body 2"], "point": ["point 1"]}
    assert names == expected | {"joint": ["spherical 1"], "driver": ["driver 1"]}


def test_names_do_not_follow_the_wording_of_messages(written, rows, mechanism):
    first = replace(mechanism.joints[0], name="spherical joint 1")
    second = replace(first, kind="screw", name="screw joint 1")
    points = (replace(mechanism.points[0], name="point of interest 1"),)
    wordy = replace(mechanism, joints=(first, second, first), points=points)
    # A screw has an angle and a stroke.
    with h5py.File(written(rows([0.0], coordinates=2), mechanism=wordy)) as file:
        assert list(file["joint/name"].asstr()) == ["spherical 1", "screw 1", "spherical 2"]
        assert list(file["point/name"].asstr()) == ["point 1"]


def test_the_file_tells_where_it_comes_from(written, rows, deck):
    with h5py.File(written(rows([0.0]))) as file:
        assert dict(file.attrs) == {
            "Conventions": "flexmb-2",
            "flexmb_version": __version__,
            "dialect": "young",
            "analysis": "kinematic",
            "deck_name": "IN2-1-1.dat",
            "deck_sha256": 64 * "0",
            "status": "complete",
            "message": "",
        }
        assert file["deck"].shape == ()
        assert file["deck"].asstr()[()] == deck.source.text


def test_what_does_not_apply_is_absent(written, rows, mechanism):
    nothing = np.zeros((1, 0, 3))
    block = replace(rows([0.0]), point_position=nothing, point_velocity=nothing, point_acceleration=nothing)
    bare = replace(mechanism, points=(), joints=(), drivers=())
    with h5py.File(written(block, mechanism=bare)) as file:
        assert sorted(file) == ["audit", "body", "deck", "euler_parameter", "time", "xyz"]


def test_a_failed_run_keeps_its_rows_and_says_why(written, rows):
    path = written(rows([0.0, 1.0]), status="failed", message="at t = 2 s no position was found")
    with h5py.File(path) as file:
        assert (file.attrs["status"], file.attrs["message"]) == ("failed", "at t = 2 s no position was found")
        assert list(file["time"]) == [0.0, 1.0]


def test_a_run_that_fails_at_once_leaves_empty_series(written):
    with h5py.File(written(status="failed", message="no assembly")) as file:
        assert file["body/position"].shape == (0, 2, 3)


def test_bytes_do_not_depend_on_the_blocks_of_the_analysis(written, rows, cut, mechanism):
    block = rows(np.arange(2500) * 1e-3)
    long = replace(mechanism, time=TimeGrid(0, 2.499, 1e-3))
    one = written(block, mechanism=long, name="one.h5")
    pieces = [cut(block, k, k + 37) for k in range(0, 2500, 37)]
    many = written(*pieces, mechanism=long, name="many.h5")
    assert one.read_bytes() == many.read_bytes()


def test_the_same_run_gives_the_same_bytes_later_and_in_another_process(written, rows, tmp_path):
    first = written(rows([0.0, 1.0, 2.0])).read_bytes()
    time.sleep(1.1)  # HDF5 keeps times in whole seconds
    assert written(rows([0.0, 1.0, 2.0])).read_bytes() == first
    again = textwrap.dedent(
        """
        import hashlib, sys
        sys.path.insert(0, sys.argv[1])
        from tests.results import conftest
        from flexmb_cli.results.hdf5.kinematic import kinematic_layout, kinematic_values
        from flexmb_cli.results.hdf5.result_file import ResultFile
        unwrap = lambda fixture: fixture.__wrapped__()
        layout = kinematic_layout(unwrap(conftest.mechanism))
        result = ResultFile(sys.argv[2], unwrap(conftest.deck), layout)
        result.rows(kinematic_values(conftest.turning_rows([0.0, 1.0, 2.0])))
        result.close()
        print(hashlib.sha256(open(sys.argv[2], "rb").read()).hexdigest())
        """
    )
    command = [sys.executable, "-c", again, str(Path(__file__).parents[3]), str(tmp_path / "other.h5")]
    reported = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert reported.strip() == hashlib.sha256(first).hexdigest()


@pytest.mark.parametrize(("count", "expected"), [(3, 3), (1, 1), (1024, 1024), (1_000_000, 1024)])
def test_chunks_are_no_longer_than_the_run(mechanism, count, expected):
    assert (
        chunk_rows(kinematic_layout(replace(mechanism, time=TimeGrid(0, float(count - 1), 1.0)))) == expected
    )


def test_chunks_of_many_bodies_stay_below_a_megabyte(mechanism):
    crowd = replace(mechanism, bodies=mechanism.bodies * 500, time=TimeGrid(0, 1e6, 1.0))
    assert 0.9 * 2**20 < chunk_rows(kinematic_layout(crowd)) * 1000 * 4 * 8 <= 2**20


def test_a_small_file_stays_small(written, rows):
    assert written(rows([0.0, 1.0, 2.0])).stat().st_size < 100_000


def test_nothing_stands_at_the_path_before_the_end(tmp_path, deck, mechanism, rows):
    path = tmp_path / "OUT.h5"
    path.write_text("old")
    result = ResultFile(path, deck, kinematic_layout(mechanism))
    result.rows(kinematic_values(rows([0.0])))
    assert path.read_text() == "old"
    result.discard()
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["OUT.h5"]


def test_a_missing_folder_is_bad_usage(tmp_path, deck, mechanism):
    with pytest.raises(OutputError, match="its folder does not exist") as caught:
        ResultFile(tmp_path / "no" / "OUT.h5", deck, kinematic_layout(mechanism))
    assert caught.value.exit_code == 2


def test_a_device_is_refused(deck, mechanism):
    with pytest.raises(OutputError, match="an HDF5 file can only be a regular file"):
        ResultFile(os.devnull, deck, kinematic_layout(mechanism))


@pytest.mark.skipif(sys.platform == "win32", reason="limits of the file size are Unix's")
def test_a_disk_that_fills_up_ends_the_run_with_exit_code_1(tmp_path):
    """The limit of the file size stands for the full disk: both fail the write itself."""
    script = textwrap.dedent(
        """
        import resource, sys
        sys.path.insert(0, sys.argv[1])
        import numpy as np
        from tests.results import conftest
        from dataclasses import replace
        from flexmb_cli.errors import OutputError
        from flexmb_cli.model.mechanism import TimeGrid
        from flexmb_cli.results.hdf5.kinematic import kinematic_layout, kinematic_values
        from flexmb_cli.results.hdf5.result_file import ResultFile
        resource.setrlimit(resource.RLIMIT_FSIZE, (400_000, 400_000))
        mechanism = replace(conftest.mechanism.__wrapped__(), time=TimeGrid(0, 1e4, 1))
        result = ResultFile(sys.argv[2], conftest.deck.__wrapped__(), kinematic_layout(mechanism))
        try:
            for _ in range(20):
                result.rows(kinematic_values(conftest.turning_rows(np.arange(1024.0))))
            result.close()
        except OutputError as error:
            print(error.exit_code, error)
        """
    )
    path = tmp_path / "OUT.h5"
    command = [sys.executable, "-c", script, str(Path(__file__).parents[3]), str(path)]
    reported = subprocess.run(command, capture_output=True, text=True, check=True)
    assert reported.stdout == f"1 {path}: no space left for the result; free some and run again\n"
    assert os.listdir(tmp_path) == []


def test_h5netcdf_opens_the_file_with_named_dimensions(written, rows):
    h5netcdf = pytest.importorskip("h5netcdf")
    with h5netcdf.File(written(rows([0.0, 1.0])), "r") as file:
        assert file["body"]["position"].dimensions == ("time", "body", "xyz")
        assert file["point"]["velocity"].dimensions == ("time", "point", "xyz")
        assert file["audit"]["newton_iterations"].dimensions == ("time",)
        assert file["joint"]["name"].dimensions == ("joint",)
        assert file.dimensions["time"].isunlimited()


def test_every_field_of_the_rows_has_its_dataset(rows):
    block = rows([0.0])
    written = {id(values) for values in kinematic_values(block).values()}
    assert [name for name, values in vars(block).items() if id(values) not in written] == []


def test_where_joints_and_points_sit_on_their_bodies_is_kept(written, rows, mechanism):
    """By hand, from the mechanism of `conftest`: a ball at body 1's origin carries body 2's end."""
    with h5py.File(written(rows([0.0]))) as file:
        assert file["joint/body"][:].tolist() == [[1, 2]]
        assert file["joint/point"][:].tolist() == [[[0, 0, 0], [-1, 0, 0]]]
        assert file["joint/axis"][:].tolist() == [[[0, 0, 0], [0, 0, 0]]]
        assert file["point/body"][:].tolist() == [2]


def test_the_kept_places_move_as_joint_and_point_do(written, rows):
    """p + A s of the kept place is the point's own series; both ends of the joint stay together."""
    with h5py.File(written(rows(np.arange(7.0)))) as file:
        e0, e1, e2, e3 = np.moveaxis(file["body/euler_parameters"][:, 1], -1, 0)
        # Turning about y only: A s of s = (-1, 0, 0) is minus the first column of A.
        first = (e0**2 + e1**2 - e2**2 - e3**2, 2 * (e1 * e2 + e0 * e3), 2 * (e1 * e3 - e0 * e2))
        column = np.stack(first, axis=-1)
        end = file["body/position"][:, 1] + file["joint/point"][0, 1, 0] * column
        assert np.max(np.abs(end - file["body/position"][:, 0])) < 1e-15
