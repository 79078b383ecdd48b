"""Results for other programs: what they read back is what the result holds."""

import csv
import hashlib
import io
import shutil
import subprocess
import time

import h5py
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.io import loadmat

from flexmb_cli.cli.export import export
from flexmb_cli.results.figures.scene import read_scene
from flexmb_cli.results.quantities.quantities import open_result
from tests.results.figures.turning_bar import tip, write_bar

TIMES = np.arange(7.0)


@pytest.fixture
def exported(tmp_path, deck, mechanism, rows):
    """The bytes that the command writes for the turning bar."""
    path = write_bar(tmp_path / "r.h5", deck, mechanism, rows, TIMES)

    def run(form):
        target = tmp_path / f"out.{form}"
        done = CliRunner().invoke(export, [str(path), "--to", form, "-o", str(target), "-q"])
        assert (done.exit_code, done.output) == (0, "")
        return target.read_bytes()

    return run


def test_csv_has_every_quantity_with_its_unit(exported):
    head, *lines = csv.reader(io.StringIO(exported("csv").decode()))
    values = np.array(lines, float)
    assert head[0] == "time [s]"
    columns = [head.index(f"point.1.{axis} [m]") for axis in "xyz"]
    assert values[:, columns] == pytest.approx(tip(TIMES), abs=1e-12)
    assert len(head) == len(set(head)) == 1 + 2 * (3 * 3 + 3 * 4 + 2 * 3) + 3 * 3 + 3


def test_matlab_reads_the_motion_the_names_and_the_deck(exported, tmp_path):
    content = loadmat(io.BytesIO(exported("mat")), simplify_cells=True)["flexmb"]
    with h5py.File(tmp_path / "r.h5") as result:
        assert np.array_equal(content["body"]["velocity"], result["body/velocity"])
        assert content["deck"] == result["deck"].asstr()[()]
    assert content["point"]["position"] == pytest.approx(tip(TIMES), abs=1e-12)
    assert list(content["body"]["name"]) == ["body 1", "body 2"]
    assert content["info"]["status"] == "complete"


OCTAVE = shutil.which("octave-cli")


@pytest.mark.campaign
@pytest.mark.skipif(OCTAVE is None, reason="Octave (Debian package octave, 240 MB) is not installed")
def test_octave_reads_every_digit(exported, tmp_path):
    """Octave loads the struct; it prints the points with seventeen digits, and the names."""
    exported("mat")
    program = (
        "load('out.mat'); printf('%d ', size(flexmb.point.position)); printf('%s,', flexmb.body.name{:});"
        "printf('\\n'); printf('%.17g\\n', flexmb.point.position); printf('%s\\n', flexmb.info.status)"
    )
    # -f: no start-up files
    done = subprocess.run(
        [OCTAVE, "-f", "-q", "--eval", program], cwd=tmp_path, capture_output=True, text=True
    )
    head, *numbers, status = done.stdout.splitlines()
    assert (head, status) == ("7 1 3 body 1,body 2,", "complete"), done.stderr
    with h5py.File(tmp_path / "r.h5") as result:
        # Octave counts the first index fastest.
        assert np.array_equal(np.array(numbers, float), result["point/position"][:].ravel(order="F"))


@pytest.mark.parametrize("form", ["csv", "mat", "vtkhdf"])
def test_the_same_result_gives_the_same_bytes_later(exported, form):
    first = hashlib.sha256(exported(form)).hexdigest()
    time.sleep(1.1)
    assert hashlib.sha256(exported(form)).hexdigest() == first


def test_vtkhdf_has_what_the_format_asks_for(exported):
    """Temporal PolyData of the VTKHDF specification: static lines, points of all steps in a row."""
    with h5py.File(io.BytesIO(exported("vtkhdf"))) as file:
        root = file["VTKHDF"]
        assert root.attrs["Type"] == b"PolyData"
        count = int(root["NumberOfPoints"][0])
        assert root["Points"].shape == (7 * count, 3)
        assert root["Steps/PointOffsets"][:].tolist() == [count * k for k in range(7)]
        assert root["Steps"].attrs["NSteps"] == 7
        assert root["Steps/Values"][:].tolist() == TIMES.tolist()
        for kind in ("Vertices", "Lines", "Strips", "Polygons"):
            assert len(root[f"{kind}/Offsets"]) == root[f"{kind}/NumberOfCells"][0] + 1
            assert root[f"{kind}/Offsets"][-1] == len(root[f"{kind}/Connectivity"])


def test_vtk_reads_the_time_series(exported, tmp_path):
    """VTK's own reader, that of ParaView, gives the times and at each the marks of all bodies."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader

    exported("vtkhdf")
    reader = vtkHDFReader()
    reader.SetFileName(str(tmp_path / "out.vtkhdf"))
    reader.UpdateInformation()
    steps = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    assert list(steps) == TIMES.tolist()
    with open_result(tmp_path / "r.h5") as file:
        scene = read_scene(file)
    marks = np.concatenate([body.marks for body in scene.bodies], axis=1)
    for k, t in enumerate(TIMES):
        reader.UpdateTimeStep(t)
        mesh = reader.GetOutput()
        assert np.array_equal(vtk_to_numpy(mesh.GetPoints().GetData()), marks[k])
        moved = vtk_to_numpy(mesh.GetPointData().GetArray("displacement"))
        assert np.allclose(moved, marks[k] - marks[0], atol=1e-15)
        assert mesh.GetLines().GetNumberOfCells() == sum(len(body.edges) for body in scene.bodies)
        assert mesh.GetVerts().GetNumberOfCells() == marks.shape[1]


def test_csv_goes_to_standard_output_and_binary_forms_do_not(
    tmp_path, monkeypatch, deck, mechanism, rows, exported
):
    path = write_bar(tmp_path / "r.h5", deck, mechanism, rows, TIMES)
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(export, [str(path), "--to", "csv", "-o", "-", "-q"])
    assert done.stdout_bytes == exported("csv")
    for form in ("vtkhdf", "mat"):
        done = CliRunner().invoke(export, [str(path), "--to", form, "-o", "-"])
        assert (done.exit_code, done.stdout) == (2, "")
        assert f"a file of the form {form} cannot go to standard output; -o names a file" in done.stderr
    assert not (tmp_path / "-").exists()
