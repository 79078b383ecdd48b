"""The search of a fit in the unit cube: least squares, constrained minimisation, differential evolution.

Least squares: trust-region reflective (Branch, Coleman, Li 1999); SLSQP (Kraft 1988); trust-constr (Conn,
Gould, Toint 2000; Byrd, Hribar, Nocedal 1999); differential evolution (Storn, Price 1997), all of SciPy.
Variants that cannot be solved are no errors: steps to them are not taken.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .fit_file import EQUAL, EVOLUTION, LEAST_SQUARES, TRUST, Fit
from .fit_variants import Variant

FEASIBLE = 1e-8  # violation that counts as none
WORST = 1e12  # cost of a variant whose violation is 0, for differential evolution
LEAST_CHANGE = 1e-13  # relative change at which a search ends


@dataclass
class Search:
    """`evaluate`: returns the variants at places (k, n) of the unit cube; `jacobian`: the derivatives
    (responses, n) at one of them.  `best`: so far, with its place.
    """

    fit: Fit
    evaluate: Callable[[np.ndarray], Sequence[Variant]]
    jacobian: Callable[[np.ndarray], np.ndarray]
    best: tuple[np.ndarray, Variant] | None = None
    message: str = ""
    success: bool = False

    def run(self, starts: np.ndarray) -> None:
        """Search from `starts` (s, n), of which the best `restarts` and the first are taken."""
        if self.fit.method == EVOLUTION:
            starts = self._evolve(starts)
        for place in starts if self.fit.method == EVOLUTION else self._chosen(starts):
            better = self.best
            success, message = self._descend(place)
            if self.best is not better or not self.message:
                self.success, self.message = success, message

    def at(self, place: np.ndarray) -> Variant:
        """Return the variant at a place; it may be the best."""
        return self.at_all(place[None])[0]

    def at_all(self, places: np.ndarray) -> Sequence[Variant]:
        """Return the variants at places (k, n); one may be the best."""
        variants = self.evaluate(places)
        for place, variant in zip(places, variants, strict=True):
            if self.best is None or rank(variant) < rank(self.best[1]):
                self.best = place.copy(), variant
        return variants

    def _chosen(self, starts: np.ndarray) -> list[np.ndarray]:
        """Return the start of the file, if it has one, and the best of a sample."""
        variants = self.at_all(starts)
        order = sorted(range(1, len(starts)), key=lambda k: rank(variants[k]))
        chosen = [0, *order][: self.fit.restarts + 1]
        return [starts[k] for k in chosen if np.isfinite(variants[k].cost)]

    def _descend(self, place: np.ndarray) -> tuple[bool, str]:
        if self.fit.targets and not self.fit.constraints and self.fit.method in (LEAST_SQUARES, EVOLUTION):
            return self._least_squares(place)
        return self._minimised(place)

    def _least_squares(self, place: np.ndarray) -> tuple[bool, str]:
        from scipy.optimize import least_squares

        end = least_squares(
            lambda u: self.at(u).residuals, place, self.jacobian, bounds=(0.0, 1.0), x_scale="jac",
            ftol=LEAST_CHANGE, xtol=LEAST_CHANGE, gtol=LEAST_CHANGE, max_nfev=self.fit.iterations,
        )  # fmt: skip
        return bool(end.success), str(end.message)

    def _minimised(self, place: np.ndarray) -> tuple[bool, str]:
        from scipy.optimize import Bounds, minimize

        scale = max(abs(self.at(place).cost), 1e-300)
        trust = self.fit.method == TRUST
        options = {"maxiter": self.fit.iterations} | (
            {"xtol": 1e-10, "gtol": 1e-14, "barrier_tol": 1e-10} if trust else {}
        )
        end = minimize(
            lambda u: self._cost(u) / scale, place, jac=lambda u: self._gradient(u) / scale,
            bounds=Bounds(np.zeros_like(place), np.ones_like(place), keep_feasible=True),
            method="trust-constr" if trust else "SLSQP", constraints=self._constraints(trust),
            options=options, tol=None if trust else LEAST_CHANGE,
        )  # fmt: skip
        variant = self.at(np.clip(end.x, 0.0, 1.0))
        return bool(end.success) and variant.violation <= 1e-6, str(end.message)

    def _cost(self, place: np.ndarray) -> float:
        """Return the cost; that of a variant that cannot be solved is far above the best."""
        variant = self.at(np.clip(place, 0.0, 1.0))
        if np.isfinite(variant.cost):
            return variant.cost
        best = abs(self.best[1].cost) if self.best else 1.0
        return 1e3 * (best if np.isfinite(best) and best > 0.0 else 1.0) * variant.violation

    def _gradient(self, place: np.ndarray) -> np.ndarray:
        place = np.clip(place, 0.0, 1.0)
        jacobian, residuals = self.jacobian(place), self.at(place).residuals
        if self.fit.objective:
            return np.asarray(jacobian[0])
        gradient: np.ndarray = np.nan_to_num(residuals) @ jacobian[: residuals.size]
        return gradient

    def _constraints(self, trust: bool) -> list[Any]:
        """Return the constraints as SciPy's methods want them, those of equality first."""
        from scipy.optimize import NonlinearConstraint

        equal = np.array([each.relation == EQUAL for each in self.fit.constraints], dtype=bool)
        constraints: list[Any] = []
        for which, kind in ((equal, "eq"), (~equal, "ineq")):
            if not which.any():
                continue

            def excess(u: np.ndarray, which: np.ndarray = which) -> np.ndarray:
                return np.asarray(np.nan_to_num(self.at(np.clip(u, 0.0, 1.0)).excess[which], nan=1.0))

            def slope(u: np.ndarray, which: np.ndarray = which) -> np.ndarray:
                return np.asarray(self.jacobian(np.clip(u, 0.0, 1.0))[-len(which) :][which])

            if trust:
                low = 0.0 if kind == "eq" else -np.inf
                constraints.append(NonlinearConstraint(excess, low, 0.0, jac=slope))
            else:
                # SLSQP wants what is at least 0.
                constraints.append({
                    "type": kind, "fun": lambda u, f=excess: -f(u), "jac": lambda u, f=slope: -f(u)
                })  # fmt: skip
        return constraints

    def _evolve(self, starts: np.ndarray) -> np.ndarray:
        """Return the end (1, n) of differential evolution, no place if nothing can be solved there."""
        from scipy.optimize import differential_evolution
        from scipy.stats import qmc

        n = starts.shape[1]
        population = qmc.LatinHypercube(n, seed=self.fit.study.seed).random(self.fit.population)
        population[0] = starts[0]

        def costs(places: np.ndarray) -> np.ndarray:
            variants = self.at_all(np.ascontiguousarray(places.T))
            return np.array([v.cost if _feasible(v) else WORST * (1.0 + v.violation) for v in variants])

        end = differential_evolution(
            costs, [(0.0, 1.0)] * n, init=population, maxiter=self.fit.iterations, tol=1e-8, polish=False,
            vectorized=True, updating="deferred", seed=self.fit.study.seed,
        )  # fmt: skip
        self.success, self.message = bool(end.success), str(end.message)
        return np.array([end.x]) if end.fun < WORST else np.zeros((0, n))


def _feasible(variant: Variant) -> bool:
    return bool(np.isfinite(variant.cost)) and variant.violation <= FEASIBLE


def rank(variant: Variant) -> tuple[float, float]:
    """Return an order of variants: what is violated, then the cost."""
    cost = variant.cost if np.isfinite(variant.cost) else np.inf
    return (0.0 if _feasible(variant) else variant.violation), cost


def confidence(jacobian: np.ndarray, residuals: np.ndarray, free: np.ndarray) -> tuple[np.ndarray, float]:
    """Return standard errors (n,) of numbers by linear regression, and the factor of their 95 % interval.

    Those that are not `free`, at a bound, and those that the residuals do not determine have none (nan).
    """
    from scipy.stats import t

    errors = np.full(len(free), np.nan)
    rest = residuals.size - int(free.sum())
    if rest < 1 or not free.any():
        return errors, float("nan")
    J = jacobian[: residuals.size][:, free]
    scale = np.maximum(np.linalg.norm(J, axis=0), 1e-300)
    _, sizes, V = np.linalg.svd(J / scale, full_matrices=False)
    if sizes[-1] > 1e-10 * sizes[0]:
        variance = float(residuals @ residuals) / rest
        errors[free] = np.sqrt(variance * np.sum((V.T / sizes) ** 2, axis=1)) / scale
    return errors, float(t.ppf(0.975, rest))
