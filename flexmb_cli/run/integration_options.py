"""`--method`, `--rtol` and `--atol`: one meaning for the forward dynamics of every dialect.

A method that a dialect does not have is refused with those that it has; where nothing is integrated, the
warning names what sets the accuracy instead.
"""

from ..dialects.vsdf.build import SPECTRAL_RADIUS, TOLERANCE
from ..errors import Fault, ModelError
from ..model.fe_model import Integrator
from ..model.flexible_mechanism import FlexibleMechanism
from ..model.loads import AlphaSteps, DynamicModel
from ..quick_dataclass import replace
from .outcome import Outcome, RunOptions

# The methods of each dialect by their names on the command line, and VSDF's own words.
METHODS = {
    "young": ("dop853", "radau", "alpha"),
    "dafms": ("dop853", "radau", "lsoda", "sdirk4"),
    "vsdf": ("dop853", "radau", "alpha"),
}
VSDF_METHOD = {"dop853": "RK45", "radau": "RAD5", "alpha": "GALF"}
RADIUS = 0.9  # spectral radius at infinity of the generalised-alpha method, where a deck gives none


def refuse_foreign_method(dialect: str, options: RunOptions) -> None:
    """Raise ModelError, with the dialect's methods, when `--method` names another."""
    method = options.integration.get("method")
    if method not in (None, *METHODS[dialect]):
        known = METHODS[dialect]
        told = f"--method {method}: a {dialect.upper()} deck is integrated by {', '.join(known[:-1])}"
        raise ModelError([Fault("error", f"{told} or {known[-1]}", id="RUN-025")])


def as_asked(model: DynamicModel, options: RunOptions) -> DynamicModel:
    """Return the model of a YOUNG deck with the method and the tolerance of the options."""
    given = options.integration
    if "rtol" in given:
        model = replace(model, tolerance=given["rtol"])
    method = given.get("method")
    if method is None:
        return model
    alpha = (model.alpha_steps or AlphaSteps(0.0, RADIUS)) if method == "alpha" else None
    return replace(model, radau=method == "radau", alpha_steps=alpha)


def mechanism_as_asked(mechanism: FlexibleMechanism, options: RunOptions) -> FlexibleMechanism:
    """Return the mechanism of a VSDF deck with the method and the tolerance of the options."""
    given, integrator = options.integration, mechanism.integrator
    method = VSDF_METHOD.get(given.get("method"), integrator.method)
    if method != integrator.method:
        integrator = Integrator(method, integrator.step, SPECTRAL_RADIUS if method == "GALF" else TOLERANCE)
    if "rtol" in given and method != "GALF":
        integrator = replace(integrator, parameter=given["rtol"])
    return replace(mechanism, integrator=integrator)


def set_tolerances(analysis: object, options: RunOptions, outcome: Outcome) -> None:
    """Set the tolerances of an analysis that chooses its steps; warn where the deck gives their length."""
    given = {name: options.integration[name] for name in ("rtol", "atol") if name in options.integration}
    if not given:
        return
    if not analysis.stepper.chosen:
        names = " and ".join(f"--{name}" for name in given)
        message = f"{names}: the deck gives the length of the steps; set it to 0, or take --method radau"
        outcome.faults.append(Fault("warning", message, id="RUN-026"))
    for name, value in given.items():
        analysis.clock[name] = value
