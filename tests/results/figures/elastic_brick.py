"""The turning bar with a block of bricks that one mode stretches along x, and what follows by hand."""

from dataclasses import replace

import h5py
import numpy as np

from scripts.brick_beam import Beam
from tests.results import conftest
from tests.results.figures.turning_bar import write_bar

STRESS = 1e6  # Pa in xx at every node, of one unit of the mode; the other components are 0
YOUNG, POISSON = 2e11, 0.3  # of steel, Pa
ENERGY = 3e-4  # J of the second element, of one unit of the mode; a third of it in the others
LENGTH = 2.0  # m, of the block along x: its far end moves by so much, of one unit of the mode


def write_brick(path, amplitude, cells=(1, 1, 1)):
    """The bar of `conftest`, its body 2 a block of `cells` bricks whose mode has `amplitude` (T,)."""
    deck, mechanism = conftest.deck.__wrapped__(), conftest.mechanism.__wrapped__()
    times = np.linspace(0.0, 3.0, len(amplitude))
    mechanism = replace(mechanism, time=replace(mechanism.time, end=3.0, step=float(times[1])))
    write_bar(path, deck, mechanism, conftest.turning_rows, times)
    placed, elements = Beam((LENGTH, 0.1, 0.1), cells, "C3D8").mesh()
    places = np.array(list(placed.values()))
    shape, stress = np.zeros((len(places), 3, 1)), np.zeros((len(places), 6, 1))
    shape[:, 0, 0], stress[:, 0, 0] = places[:, 0], STRESS
    with h5py.File(path, "r+") as file:
        group = file.create_group("elastic/body 2")
        group["node_position"], group["shape"], group["stress_shape"] = places, shape, stress
        group["node"], group["cell"] = np.array(list(placed)), np.array(elements)
        group["element"] = np.arange(1, len(elements) + 1)
        group["young_modulus"], group["poisson_ratio"] = YOUNG, POISSON
        modal = file.create_group("modal/body 2")
        modal["amplitude"], modal["rate"] = amplitude[:, None], np.zeros((len(amplitude), 1))
    return path


def select_elements(path, *numbers):
    """Let the result have what `OUTS` selects of elements: stress and strain of the mode, and energies."""
    with h5py.File(path, "r+") as file:
        amplitude = np.repeat(file["modal/body 2/amplitude"][:], len(numbers), axis=1)
        stress, strain = np.zeros((*amplitude.shape, 6)), np.zeros((*amplitude.shape, 6))
        stress[..., 0] = STRESS * amplitude
        strain[..., :3] = stress[..., :1] / YOUNG * (1, -POISSON, -POISSON)
        group, strains = file.create_group("stress/body 2"), file.create_group("strain/body 2")
        group["element"] = np.array(numbers)
        group["element_tensor"], group["element_von_mises"] = stress, np.abs(stress[..., 0])
        group["element_principal"] = np.sort(stress[..., :3])[..., ::-1]
        strains["element_tensor"] = strain
        strains["element_energy"] = ENERGY * amplitude**2 * np.where(np.array(numbers) == 2, 1, 1 / 3)
