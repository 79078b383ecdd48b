"""The variants of a study: settings of the deck's numbers, case by case."""

import numpy as np

from .study import LATIN, Study


class Cases:
    """Parameter values of every case of a study, made when they are requested.

    A sample is that of SciPy's Latin hypercube with the study's seed: any process has the same.
    """

    def __init__(self, study: Study):
        self.study = study
        self._sample: np.ndarray | None = None

    def row(self, case: int) -> list[float | int]:
        """Values of the parameters of case number `case`, counted from 0."""
        if self.study.sampling != LATIN:
            return self.study.row_of(case)
        if self._sample is None:
            self._sample = _sample(self.study)
        return list(self._sample[case].tolist())

    def settings(self, case: int) -> list[str]:
        """The same as `--set` takes them."""
        named = zip(self.study.parameters, self.row(case), strict=True)
        return [f"{item.name}={value!r}" for item, value in named]


def _sample(study: Study) -> np.ndarray:
    from scipy.stats import qmc

    parameters = study.parameters
    unit: np.ndarray = qmc.LatinHypercube(len(parameters), seed=study.seed).random(study.count)
    for k, item in enumerate(parameters):
        low, high = np.log(item.values) if item.logarithmic else item.values
        column = low + unit[:, k] * (high - low)
        unit[:, k] = np.exp(column) if item.logarithmic else column
    return unit
