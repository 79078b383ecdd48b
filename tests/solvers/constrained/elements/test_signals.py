"""Signals and controllers in all dialects, against closed forms and problems of `reference/motion`."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from flexmb_cli.kernels import signals as kernel
from flexmb_cli.kernels.constrained import time_functions as kernel_functions
from flexmb_cli.model import signals as model
from flexmb_cli.model import time_functions
from flexmb_cli.run.mechanism_modes import Wish
from flexmb_cli.run.modes import modes_of_deck
from flexmb_cli.run.outcome import Listener, RunOptions
from tests.dialects.dafms.test_dafms_elements import rows_of as dafms_rows
from tests.dialects.vsdf.test_elements import rows_of as vsdf_rows
from tests.solvers.constrained.element_decks import ROTOR
from tests.solvers.constrained.element_decks import rows_of as young_rows
from tests.solvers.constrained.elements.test_bristles import faults_of

DECKS = Path(__file__).resolve().parents[4] / "decks"
# A rotor about z with the moment of inertia J: YOUNG, VSDF and DAFMS, where its angle is ANGLE.
METHODS = ("young RK45", "young RAD5", "young GALF", "vsdf RK45", "vsdf RAD5", "dafms dop853", "dafms sdirk4")
_CARDS = {"RK45": "TOLERANCE 1e-11\n", "RAD5": "RAD5 1e-11\n", "GALF": "GALF 0 0.9\nTOLERANCE 1e-9\n"}


def run(method, J, end, step, lines):
    """Rows of the rotor with the lines of a block, by a dialect and a method."""
    dialect, name = method.split()
    block = "ELEMENTS\n" + lines.replace("ANGLE", "1.r3" if dialect == "dafms" else "1.angle")
    if dialect == "young":
        cards = f"MASS 2 1 0 0 0 0.1 0.1 {J}\nGRAVITY 0 0 0\n{_CARDS[name]}{block}"
        return young_rows(ROTOR, f"0 {end} {step}", cards)
    if dialect == "vsdf":
        deck = (
            f"VSDF ROTOR\nBODY\n 1,RIGD\nRIGI\n 1,1,0,0,0\n 0.1,0.1,{J},0,0,0\n"
            "NODE\n 0,1,0,0,0\n 0,2,0,0,1\n 1,1,0,0,0\n 1,2,0,0,1\n"
            "JOIN\n 1,REVO,0,1,2,1,1,2\nGRAV\n 0,0,0\n"
        )
        return vsdf_rows(deck, end, step, block, name)
    return dafms_rows(block, name, dafms_rotor(J, end, step))


def dafms_rotor(J, end, step):
    """The deck up to its blocks."""
    return (
        f"    1    3\nDFMB ROTOR\n    1    0    0    0    0\n    1    1    0    0    1\n    0\n    0\n"
        f"{round(end / step):5d}\n{step:10.5f}\nCONN\n    0\nMASS\n    1       1.0\nINER\n"
        f"    1        .1        .1{J:10.5f}\nQ(k)\n    1       0.0       0.0       0.0\n"
        "EULT\n    1       0.0       0.0       0.0       1.0\n"
        "EULL\n    1       0.0       0.0       0.0       1.0\nTOLR\n    1.000E-11    1.000E-12\n"
    )


def test_codes_are_those_of_the_model():
    names = [name for name in vars(model) if name.endswith("_SIGNAL")]
    assert len(names) == 12
    for name in names:
        assert getattr(kernel, name) == getattr(model, name)
    assert kernel_functions.SIGNAL == time_functions.SIGNAL


PID = """  FUNCTION pull polynomial -0.5
  SPRING drag at=ANGLE damping=0.01
  MOTOR load at=ANGLE effort=pull
  SIGNAL error sum 0.8 -ANGLE
  SIGNAL i integral of=error
  SIGNAL u pid of=error kp=3 ki=10 kd=0.2
  MOTOR m at=ANGLE effort=u"""
PID_TIMES = (0.05, 0.1, 0.2, 0.4, 0.8, 1.5, 3.0)
PID_ANGLES = (0.104554001501, 0.352606303049, 0.887266865192, 0.944895895938, 0.819661816754, 0.806198350893,
              0.799951792041)  # fmt: skip
PID_TORQUES = (1.69431518978, 0.873469632933, -0.238709175668, 0.381961730409, 0.383481850619, 0.486499251956,
               0.500086183792)  # fmt: skip
PID_INTEGRALS = (0.0381944608966, 0.067146538524, 0.0837142315554, 0.0384958229009, 0.0550626791681,
                 0.0501649607305, 0.04999966011)  # fmt: skip


@pytest.mark.long_motion
@pytest.mark.parametrize("method", METHODS)
def test_a_pid_turns_a_rotor_to_its_set_point(method):
    """Problem control-pid-rotor of `reference/motion`: matrix exponential, tolerances 1e-8 and 1e-7."""
    rows = run(method, 0.02, 3.0, 0.05, PID)
    at = [round(t / 0.05) for t in PID_TIMES]
    assert rows.element_coordinate[at, -1] == pytest.approx(PID_ANGLES, abs=1e-8)
    assert rows.element_effort[at, -1] == pytest.approx(PID_TORQUES, abs=1e-7)
    assert rows.signal_value[at, 1] == pytest.approx(PID_INTEGRALS, abs=1e-8)
    assert rows.signal_value[:, 2] == pytest.approx(rows.element_effort[:, -1], abs=0.0)


# Roots of 0.02 s³ + 0.21 s² + 3 s + 10.
EIGENVALUES = (-4.03507115688, -3.23246442156 - 10.6519822501j, -3.23246442156 + 10.6519822501j)


def rotor_modes(dialect, folder, lines):
    """Linearised motion of the rotor with the lines of a block."""
    lines = lines.replace("ANGLE", "1.r3" if dialect == "dafms" else "1.angle")
    if dialect == "young":
        cards = f"MASS 2 1 0 0 0 0.1 0.1 0.02\nGRAVITY 0 0 0\nELEMENTS\n{lines}"
        text = f"{ROTOR}0 3 0.05\nDYNAMICS forward\n{cards}\nEND\n"
    else:
        text = f"{dafms_rotor(0.02, 3.0, 0.05)}ELEMENTS\n{lines}\nEND \nSTAR\nSTOP\n"
    path = folder / "rotor.dat"
    path.write_text(text)
    return modes_of_deck(str(path), Wish(state_space=True), RunOptions(), Listener()).mechanism


@pytest.mark.parametrize("dialect", ["young", "dafms"])
def test_modes_have_the_states_of_controllers(dialect, tmp_path):
    """Eigenvalues of the same problem: roots of the characteristic polynomial of the closed loop, 1e-8."""
    found = rotor_modes(dialect, tmp_path, PID.replace("  SIGNAL i integral of=error\n", "")).modes
    assert found.degrees_of_freedom == 1
    known = sorted(found.eigenvalues, key=lambda value: value.imag)
    assert known == pytest.approx(sorted(EIGENVALUES, key=lambda value: value.imag), abs=1e-8)


@pytest.mark.parametrize("dialect", ["young", "dafms"])
def test_the_state_space_has_the_states_of_controllers_and_blocks(dialect, tmp_path):
    """From a torque M to the error, the torque of the PID and a block 5/(0.3 s + 1) of it, in closed form.

    The angle is M s / (J s³ + (d + kd) s² + kp s + ki).
    """
    lag = "\n  SIGNAL y transfer of=u numerator=5 denominator=(0.3,1)"
    space = rotor_modes(dialect, tmp_path, PID + lag).space
    assert [state.name for state in space.states[2:]] == ["i state 1", "u state 1", "y state 1"]
    number = [one.name for one in space.inputs].index("load effort")
    outputs = [[one.name for one in space.outputs].index(name) for name in ("error", "u", "y")]
    for w in (0.3, 3.0, 12.0, 80.0):
        s = 1j * w
        angle = s / (0.02 * s**3 + 0.21 * s**2 + 3.0 * s + 10.0)
        control = -angle * (3.0 + 10.0 / s + 0.2 * s)
        inside = np.linalg.solve(s * np.eye(5) - space.A, space.B[:, number])
        found = (space.C @ inside + space.D[:, number])[outputs]
        assert found == pytest.approx([-angle, control, control * 5.0 / (0.3 * s + 1.0)], abs=1e-8)


@pytest.mark.parametrize("dialect", ["young", "dafms"])
def test_modes_of_a_bearing_that_sticks_have_its_bristles_as_springs(dialect, tmp_path):
    """J s² + N r² (s1 s + s0) = 0 about standstill, and 0 for the place at which it sticks."""
    found = rotor_modes(
        dialect,
        tmp_path,
        "  FRICTION f joint=1 dynamic=0.2 static=0.3 stribeck=0.1 radius=0.05 preload=8\n"
        "    bristle=2e3 bristle_damping=12",
    )
    normal = 8.0 if dialect == "young" else 17.8  # with the weight of 9.8 N that DAFMS decks have
    roots = [0.0, 0.0, *np.roots([0.02, normal * 0.05**2 * 12.0, normal * 0.05**2 * 2e3])]
    known = sorted(np.linalg.eigvals(found.space.A), key=lambda value: (value.imag, value.real))
    assert known == pytest.approx(sorted(roots, key=lambda value: (value.imag, value.real)), abs=1e-6)


def sampled_rotor(kp, delay, steps, J=0.05, damping=0.1, period=0.05):
    """Angles and torques at the samples by the exact discrete matrix of a rotor with held torque."""
    A = np.array([[0.0, 1.0, 0.0], [0.0, -damping / J, 1.0 / J], [0.0, 0.0, 0.0]])
    move = expm(A * period)
    x, queue, angles, torques = np.zeros(2), [0.0] * delay, [], []
    for _ in range(steps):
        queue.append(kp * (1.0 - x[0]))
        torque = queue.pop(0)
        angles.append(x[0])
        torques.append(torque)
        x = (move @ [*x, torque])[:2]
    return np.array(angles), np.array(torques)


@pytest.mark.long_motion
@pytest.mark.parametrize("delay", [0, 1, 3])
@pytest.mark.parametrize("method", METHODS)
def test_a_sampled_controller_holds_its_torque_from_sample_to_sample(method, delay):
    """The closed form of zero-order hold: exp(A T) of rotor and torque, the torque late by whole periods."""
    lines = (
        "  SPRING drag at=ANGLE damping=0.1\n  SIGNAL error sum 1 -ANGLE\n"
        f"  SIGNAL u pid of=error kp=0.5 period=0.05 delay={0.05 * delay}\n  MOTOR m at=ANGLE effort=u"
    )
    rows = run(method, 0.05, 1.0, 0.05, lines)
    angles, torques = sampled_rotor(0.5, delay, 21)
    assert rows.element_coordinate[:, -1] == pytest.approx(angles, abs=1e-8)
    # Rows at samples are those after them, the last one too.
    assert rows.element_effort[:, -1] == pytest.approx(torques, abs=1e-8)


# Problem control-sampled-p of `reference/motion`: angle and held torque by gain and delay; at the second gain
# the spectral radius is 1.
SAMPLED_TIMES = (0.02, 0.05, 0.13, 0.31, 0.5, 1.03, 2.01, 5.0)
SAMPLED = {
    (0.5, 0): (
        (
            0.00197359788081,
            0.0120935450899,
            0.0771092356831,
            0.372935110525,
            0.779367984974,
            1.4053602205,
            0.838844176929,
            1.00905585772,
        ),
        (
            0.5,
            0.493953227455,
            0.476659685569,
            0.323592223539,
            0.110316007513,
            -0.201393404998,
            0.0800025643752,
            -0.00452792885962,
        ),
    ),
    (4.06778512199, 0): (
        (
            0.0160563441927,
            0.0983878855775,
            0.597461047023,
            1.92631438573,
            1.26954544998,
            1.96016465573,
            0.470996467645,
            0.0708045679769,
        ),
        (
            4.06778512199,
            3.66756434485,
            2.55748477403,
            -3.61485495863,
            -1.09645297112,
            -3.46877056804,
            1.83444625727,
            3.7797673538,
        ),
    ),
    (0.5, 1): (
        (
            0.0,
            0.0,
            0.0303594724155,
            0.281961695439,
            0.705087405979,
            1.52793536596,
            0.72807334512,
            1.03535344508,
        ),
        (0.0, 0.5, 0.5, 0.412593118556,
         0.206440075571, -0.245061224142, 0.124982330548, -0.0152794635278),
    ),
}  # fmt: skip


@pytest.mark.parametrize("method", ["young RK45", "dafms sdirk4"])
@pytest.mark.parametrize(("kp", "delay"), SAMPLED)
def test_a_sampled_controller_at_and_below_its_limit_has_the_printed_values(method, kp, delay):
    """Closed form, tolerance 1e-7, between samples too; at a sample the torque is the new one."""
    lines = (
        "  SPRING drag at=ANGLE damping=0.1\n  SIGNAL error sum 1 -ANGLE\n"
        f"  SIGNAL u pid of=error kp={kp} period=0.05 delay={0.05 * delay}\n  MOTOR m at=ANGLE effort=u"
    )
    rows = run(method, 0.05, 5.0, 0.01, lines)
    at = [round(100.0 * t) for t in SAMPLED_TIMES]
    angles, torques = SAMPLED[kp, delay]
    assert rows.element_coordinate[at, -1] == pytest.approx(angles, abs=1e-7)
    assert rows.element_effort[at, -1] == pytest.approx(torques, abs=1e-7)


@pytest.mark.parametrize("method", ["dop853", "sdirk4"])
def test_samples_leave_the_motion_of_a_spherical_hinge_as_it_is(method):
    """The same tree without samples, whose steps do not end at them: 1e-7 by its tolerance."""
    text = (DECKS / "dafms" / "spatial_rigid.DAT").read_text()
    shorter = text[: text.index("END ")].replace("  200\n", "   40\n")
    angle = "ELEMENTS\n  SIGNAL angle sum 2.r3"
    free = dafms_rows(angle, method, shorter).signal_value[:, 0]
    samples = "\n  SIGNAL held pid of=angle kp=1 period=0.05 delay=0.02"
    rows = dafms_rows(angle + samples, method, shorter)
    assert np.ptp(free) > 0.1
    assert rows.signal_value[:, 0] == pytest.approx(free, abs=1e-7)
    held = np.concatenate([np.zeros(2), np.repeat(free[::5], 5)])[: free.size]
    assert rows.signal_value[:, 1] == pytest.approx(held, abs=1e-7)


BLOCKS = """  SIGNAL one sum 1
  SIGNAL second transfer of=one numerator=(100) denominator=(1,4,100)
  SIGNAL lead transfer of=one numerator=(2,10) denominator=(1,5)
  SIGNAL wave sum 3*time
  SIGNAL x state of=(one,wave) a=(0,1,-9,-0.6) b=(0,0,1,0.5) c=(1,0.2) d=(0,0.1) start=(0.3,-1)
  SIGNAL cut limit of=wave lower=0.5 upper=2
  SIGNAL dead deadzone of=wave lower=0.5 upper=2
  SIGNAL swap switch of=wave level=1.5 width=1 below=one above=wave
  SIGNAL ratio product 2 wave /x
  SIGNAL grown table of=wave function=square
  SIGNAL rate sum 1 wave.rate
  FUNCTION square polynomial 0 0 1"""


@pytest.mark.parametrize(
    "method",
    [
        "young RK45",
        *(
            pytest.param(m, marks=pytest.mark.long_motion)
            for m in ("vsdf RAD5", "young GALF", "dafms sdirk4")
        ),
    ],
)
def test_blocks_answer_as_in_textbooks(method):
    """A second-order lag by its step response (Ogata, Modern Control Engineering, section 5.3), a lead by its
    own; a state space by the matrix exponential; the others by their formulas.
    """
    rows = run(method, 0.05, 1.0, 0.1, BLOCKS)
    t, value = 0.1 * np.arange(11), dict(zip(NAMES, rows.signal_value.T, strict=True))
    zeta, omega = 0.2, 10.0
    damped, fade = omega * math.sqrt(1.0 - zeta**2), np.exp(-zeta * omega * t)
    swing = np.cos(damped * t) + zeta / math.sqrt(1.0 - zeta**2) * np.sin(damped * t)
    near_blocks = 3e-5 if "GALF" in method else 1e-7
    assert value["second"] == pytest.approx(1.0 - fade * swing, abs=near_blocks)
    assert value["lead"] == pytest.approx(
        2.0 * np.exp(-5.0 * t) + 2.0 * (1.0 - np.exp(-5.0 * t)), abs=near_blocks
    )
    A, B = np.array([[0.0, 1.0], [-9.0, -0.6]]), np.array([[0.0, 0.0], [1.0, 0.5]])
    # State, 1 and 3 t: the latter two move by themselves.
    whole = np.zeros((4, 4))
    whole[:2, :2], whole[:2, 2:], whole[3, 2] = A, B, 3.0
    states = np.array([expm(whole * time) @ [0.3, -1.0, 1.0, 0.0] for time in t])
    x = states[:, 0] + 0.2 * states[:, 1] + 0.1 * 3.0 * t
    assert value["x"] == pytest.approx(x, abs=near_blocks)
    wave = 3.0 * t
    assert value["cut"] == pytest.approx(np.clip(wave, 0.5, 2.0), abs=1e-14)
    assert value["dead"] == pytest.approx(wave - np.clip(wave, 0.5, 2.0), abs=1e-14)
    s = np.clip(wave - 1.0, 0.0, 1.0)
    assert value["swap"] == pytest.approx(1.0 + s * s * (3.0 - 2.0 * s) * (wave - 1.0), abs=1e-14)
    assert value["ratio"] == pytest.approx(2.0 * wave / value["x"], rel=1e-13)
    assert value["grown"] == pytest.approx(wave**2, abs=1e-14)
    assert value["rate"] == pytest.approx(4.0, abs=1e-14)


NAMES = [line.split()[1] for line in BLOCKS.splitlines() if "SIGNAL" in line]


@pytest.mark.parametrize(
    ("quantity", "remedy"),
    [("1.angle.acceleration", "measure a rate"), ("revolute-1.torque", "SPRING"), ("arm.4.stress", "gauge")],
)
def test_quantities_that_are_no_inputs_name_what_to_measure(quantity, remedy):
    (fault,) = faults_of(f"SIGNAL x sum 1*{quantity}", ROTOR)
    assert (fault.id, remedy in fault.message) == ("ELEMENTS-274", True)
