"""Judges a result by its deck and rows alone: nothing of flexmb computes here, only numpy.

What a body does at a point is put together from its origin, Euler parameters, angular velocity and
acceleration; joints, drivers and grounds are those of the deck's own numbers where it can be read plainly
(young_text.py), else those that the result keeps.
"""

import numpy as np

from .dafms import judge_dafms
from .dafms_text import DafmsText
from .rates import judge_rates
from .rows import ROUND_OFF, Bodies, Result, Verdict, small
from .vsdf import judge_vsdf
from .vsdf_text import VsdfText
from .young import judge_young
from .young_text import YoungText

ENERGY = 2e-3  # of the largest energy: flexmb warns of a thousandth
STATED = 1.1  # of the drift that a warning states with two digits


def judge(
    path,
    text,
    warned: float = 0.0,
    coarse: bool = False,
    judged: list[str] | None = None,
    smooth: bool = True,
) -> str:
    """What is wrong with the result at `path`, "" for nothing; `text`: that of its deck, or None.

    `warned`: the drift of its energy, J, of which the run itself warned; `coarse`: it did of its steps;
    `smooth`: no element of the deck has corners.  `judged` gets a word when rows were compared,
    and one for whatever of the deck was not.
    """
    result, judged = Result(path), [] if judged is None else judged
    try:
        _finite(result)
        # Rows of a run that failed are marked; what made it fail may begin in the last of them.
        if result.complete and len(result["time"]):
            with np.errstate(all="ignore"):
                _attitudes(result)
                _by_deck(result, text, judged)
                if not isinstance(text, YoungText) and judge_rates(result, smooth, coarse):
                    judged.append(f"rates of {result.attributes['dialect']} decks compared")
                _kept_joints(result)
                _energies(result, warned)
                _tree_closures(result)
    except Verdict as wrong:
        return str(wrong)
    return ""


def _by_deck(result, text, judged):
    if isinstance(text, YoungText):
        judge_young(result, text)
    elif isinstance(text, VsdfText):
        judge_vsdf(result, text, judged)
    elif isinstance(text, DafmsText):
        judge_dafms(result, text, judged)
    else:
        judged.append(f"not judged: text of a {result.attributes['dialect']} deck")


def _finite(result):
    for name, values in result.data.items():
        if values.dtype.kind == "f" and not np.isfinite(values).all():
            raise Verdict(f"{name} is not finite")
    if (np.diff(result["time"]) <= 0).any():
        raise Verdict("times do not ascend")


def _attitudes(result):
    """Euler parameters are of length one, and their rates those of the angular velocity."""
    if "body/euler_parameters" not in result:
        return
    p, pd = result["body/euler_parameters"], result["body/euler_parameter_rates"]
    pdd, omega = result["body/euler_parameter_accelerations"], result["body/angular_velocity"]
    alpha = result["body/angular_acceleration"]
    small("length of the Euler parameters", (p * p).sum(-1) - 1, p[..., 0] * 0)
    small("rate of the Euler parameters' length", (p * pd).sum(-1), omega)
    small("second rate of that length", (p * pdd + pd * pd).sum(-1), np.concatenate([alpha, omega**2], -1))
    e0, e, e0d, ed = p[..., :1], p[..., 1:], pd[..., :1], pd[..., 1:]
    spin = 2 * (e0 * ed - e * e0d + np.cross(e, ed))
    small("angular velocity against the rates", spin - omega, omega)
    e0dd, edd = pdd[..., :1], pdd[..., 1:]
    spin = 2 * (e0 * edd - e * e0dd + np.cross(e, edd))
    small("angular acceleration against the rates", spin - alpha, np.concatenate([alpha, omega**2], -1))


def _kept_joints(result):
    """A complete result does not state itself that its joints are open."""
    if "audit/constraint_residual" not in result:
        return
    largest = result["audit/constraint_residual"]
    if largest.max() > 1e-3:
        raise Verdict(f"the result states a residual of {largest.max():.3g}")


def _tree_closures(result):
    """Closures of trees of rigid bodies stay closed."""
    trees = result.attributes["dialect"] == "dafms"  # joints of others may slide
    if not trees or "joint/point" not in result or "elastic" in " ".join(result.data):
        return
    bodies = Bodies(result)
    for k, ((a, b), (s, w)) in enumerate(zip(result["joint/body"], result["joint/point"], strict=True), 1):
        one, other = bodies.point(int(a), s), bodies.point(int(b), w)
        gap, stated = other[0] - one[0], result["audit/constraint_residual"]
        if (np.abs(gap).max(axis=1) > stated + ROUND_OFF * (1 + np.abs(one[0]).max())).any():
            raise Verdict(f"closure {k} is open by {np.abs(gap).max():.3g}, beyond what is stated")


def _energies(result, warned):
    """The parts make the total, which stays but for the drift that the run warned of."""
    if "energy/total" not in result:
        return
    parts = {name: result[f"energy/{name}"] for name in ("kinetic", "potential", "applied_work")}
    strain = result.data.get("energy/strain", 0.0)
    total = result["energy/total"]
    made = parts["kinetic"] + parts["potential"] + strain - parts["applied_work"]
    size = sum(np.abs(values) for values in parts.values()) + np.abs(strain)
    small("sum of the energies", made - total, size)
    if (parts["kinetic"] < -ROUND_OFF * size).any():
        raise Verdict("the kinetic energy is negative")
    scale = (
        max(np.abs(values - values[0]).max() for values in parts.values()) + np.abs(parts["kinetic"]).max()
    )
    drift = np.abs(total - total[0]).max()
    allowed = max(ENERGY * scale + 1e-9 * size.max(), STATED * warned)
    if result.complete and drift > allowed:
        raise Verdict(f"the total energy strays by {drift:.3g} of {scale:.3g} without a warning")
