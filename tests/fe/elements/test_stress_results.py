"""Stresses in results: from the cards MATL and OUTS to names of quantities; energies against the body's."""

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.run import run
from flexmb_cli.cli.table import table
from flexmb_cli.fe.build_mechanism import flexible_mechanism
from tests.dialects.vsdf.vsdf_decks import DECKS, build, reported, supplied

MATERIAL = "MATL\n    2    2.1E11       0.3    7850.0\n"


def rod(*lines, material=MATERIAL):
    """The slider-crank whose rod is of CalculiX's C3D20R, with lines of OUTS."""
    cards = material + "".join(["OUTS\n", *(f"{line}\n" for line in lines)])
    return supplied(
        "slider_crank_flex", ("OUTN\n", f"{cards}OUTN\n"), ("       0.5     0.005", "     0.002     0.001")
    )


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    folder = tmp_path_factory.mktemp("stress")
    (folder / "fe").symlink_to(DECKS / "fe")
    path = folder / "rod.vsdf"
    path.write_text(rod("    2 NODE   45    7", "    2 ELEM", "    2 MAX"))
    done = CliRunner().invoke(run, [str(path), "-q", "-o", str(folder)])
    assert done.exit_code == 0, done.output
    return folder / "rod.h5"


@pytest.mark.long_motion
def test_element_energies_add_up_to_the_strain_energy_of_the_modes(result):
    """The body's is eta' K eta / 2 with CalculiX's stiffness matrix, which has fourteen digits."""
    with h5py.File(result) as file:
        energies = file["strain/body 2/element_energy"][:]
        assert energies.shape == (3, 8)
        np.testing.assert_allclose(energies.sum(axis=1)[1:], file["energy/strain"][1:], rtol=1e-6)


def test_quantities_have_names_by_nodes_and_elements(result):
    names = [
        "stress.2.node45.xx",
        "stress.2.45.von_mises",
        "stress.2.element3.principal.1",
        "stress.2.max.von_mises",
    ]
    names += ["strain.2.element3.energy", "strain.2.node7.xy", "strain.2.node45.principal.1"]
    done = CliRunner().invoke(table, [str(result), *names, "-q"])
    assert done.exit_code == 0, done.output
    heading = done.stdout.splitlines()[0]
    assert "stress.2.node45.von_mises [Pa]" in heading
    assert "strain.2.element3.energy [J]" in heading
    assert "strain.2.node45.principal.1 [1]" in heading


def test_the_largest_stress_is_that_of_all_nodes(result):
    with h5py.File(result) as file:
        group = file["elastic/body 2"]
        stress = np.einsum("sam,tm->tsa", group["stress_shape"][:], file["modal/body 2/amplitude"][:])
        xx, yy, zz, xy, yz, zx = np.moveaxis(stress, -1, 0)
        mises = np.sqrt(xx**2 + yy**2 + zz**2 - xx * yy - yy * zz - zz * xx + 3 * (xy**2 + yz**2 + zx**2))
        np.testing.assert_allclose(file["stress/body 2/max_von_mises"][1:], mises.max(axis=1)[1:], rtol=1e-9)
        nodes = group["node"][:]
        assert file["stress/body 2/max_node"][-1] == nodes[mises[-1].argmax()]


def test_strains_are_hookes(result):
    with h5py.File(result) as file:
        stress, strain = (file[f"{name}/body 2/node_tensor"][-1, 0] for name in ("stress", "strain"))
    young, poisson = 2.1e11, 0.3
    shear = young / (2 * (1 + poisson))
    assert strain[3:] == pytest.approx(stress[3:] / (2 * shear), rel=1e-12)
    expected = [(stress[a] - poisson * (stress[:3].sum() - stress[a])) / young for a in range(3)]
    assert strain[:3] == pytest.approx(expected, rel=1e-9)


FAULTS = {
    "    2 NODE  999": "stress output 1: body 2 has no node 999",
    "    1 MAX": "stress output 1: body 1 is RIGD and has no stresses",
    "    4 MAX": "stress output 1: body number 4 is outside 1..3",
    "    2 MAX     7": "stress output 1: MAX is of all nodes; read 7: leave the field empty",
}


@pytest.mark.parametrize("line", FAULTS)
def test_what_cannot_be_reported_is_told_at_its_card(line):
    assert any(FAULTS[line] in fault for fault in reported(rod(line))), reported(rod(line))


def test_stresses_without_a_material_are_refused():
    text = rod("    2 MAX", material="")
    assert any(
        "stresses of body 2 need its material; give E and nu on a card MATL" in one for one in reported(text)
    )


@pytest.mark.parametrize("line, message", [
    ("MATL\n    2    1.0E11       0.3\n", "the stiffness matrix differs by"),
    ("MATL\n    2    2.1E11       0.3    2700.0\n", "check the density, or the units of the files"),
])  # fmt: skip
def test_a_material_that_is_not_that_of_the_matrices_is_told(line, message, tmp_path):
    from flexmb_cli.errors import ModelError

    try:
        faults = flexible_mechanism(build(rod("    2 MAX", material=line)), cached=False)[1]
    except ModelError as refused:
        faults = refused.faults
    assert any(message in fault.message for fault in faults)


@pytest.mark.parametrize(
    "lines", [["    2 ELEM    3   99", "    2 ELEM   98    1"], ["    2 ELEM", "    2 ELEM    3   99   98"]]
)
def test_elements_that_are_not_there_are_told_at_their_fields(lines):
    """All of them; a line that selects every element hides none."""
    from flexmb_cli.errors import ModelError

    with pytest.raises(ModelError, match="body 2 has no element 99; its elements are 1 to 8") as caught:
        flexible_mechanism(build(rod(*lines)), cached=False)
    text = rod(*lines).splitlines()
    marked = [
        text[one.place.line - 1][one.place.column - 1 :][: one.place.width] for one in caught.value.faults
    ]
    assert sorted(marked) == ["98", "99"]


def test_principal_strains_are_those_of_the_strain_tensors(result):
    """By the roots of det(eps - x E) = 0, from the tensors of nodes and elements."""
    with h5py.File(result) as file:
        for kind in ("node", "element"):
            tensors = file[f"strain/body 2/{kind}_tensor"][-1]
            found = file[f"strain/body 2/{kind}_principal"][-1]
            for (xx, yy, zz, xy, yz, zx), values in zip(tensors, found, strict=True):
                size = max(abs(values))
                full = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
                residuals = [np.linalg.det((full - x * np.eye(3)) / size) for x in values]
                assert residuals == pytest.approx([0, 0, 0], abs=1e-12)
                assert values.sum() == pytest.approx(xx + yy + zz, abs=1e-12 * size)
                assert (np.diff(values) <= 0).all()
