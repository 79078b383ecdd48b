"""States of the integrators of mechanisms under constraints between calls: a named tuple for each."""

from typing import NamedTuple

import numpy as np

from ..constrained.system import Work


class Integration(NamedTuple):
    """State of an integration between calls, for states of N numbers."""

    clock: np.ndarray  # (1,) CLOCK record
    z: np.ndarray  # (N,) state at the time t: m, 1, m/s, rad/s, J
    old: np.ndarray  # (N,) state at the start of the last step, in the same units
    trial: np.ndarray  # (N,) state that is tried or reported, in the same units
    slopes: np.ndarray  # (16, N) rates of the stages, units of the state a second
    dense: np.ndarray  # (7, N) terms of the dense output, units of the state
    units: np.ndarray  # (N,) a state's unit, of which the absolute tolerance is
    angles: np.ndarray  # (3, angles) rad, see `angle_unwrapping`


class AlphaIntegration(NamedTuple):
    """State of an integration between calls, for n speeds, states of N numbers, m equations."""

    clock: np.ndarray  # (1,) CLOCK record
    memory: np.ndarray  # (1,) MEMORY record
    z: np.ndarray  # (N,) state at the time t: m, 1, m/s, rad/s, J
    old: np.ndarray  # (N,) state at the start of the last step, in the same units
    trial: np.ndarray  # (N,) state that is tried or reported, in the same units
    units: np.ndarray  # (N,) a state's unit, of which the absolute tolerance is
    angles: np.ndarray  # (3, angles) rad, see `angle_unwrapping`
    rates: np.ndarray  # (5, n) accelerations, m/s² or 1/s², rows as in `generalised_alpha_step`
    missing: np.ndarray  # (3, n) forces missing in the equations of motion, scaled; zeros in rows 1, 2
    corrections: np.ndarray  # (3, n) of accelerations, speeds and positions, scaled
    free: np.ndarray  # (3, n) their parts along the free motions, scaled
    gaps: np.ndarray  # (3, m) missing, in units of the equations: ACCELERATION_GAP, SPEED_GAP, POSITION_GAP
    load_powers: np.ndarray  # (3, K) of each load whose work is kept, rows NOW, BEHIND and TRIED, W
    newton: Work  # whose `reduced` is the matrix of an iteration
    state_rates: np.ndarray  # (3, s) rates of the states of signals, 1/s, rows NEW, LAST, BEFORE


class RadauIntegration(NamedTuple):
    """State of an integration between calls, for n speeds and states of N numbers."""

    clock: np.ndarray  # (1,) CLOCK record
    memory: np.ndarray  # (1,) MEMORY record
    z: np.ndarray  # (N,) state at the time t: m, 1, m/s, rad/s, J
    old: np.ndarray  # (N,) state at the start of the last step, in the same units
    trial: np.ndarray  # (N,) state that is tried or reported, in the same units
    units: np.ndarray  # (N,) a state's unit, of which the absolute tolerance is
    angles: np.ndarray  # (3, angles) rad, see `angle_unwrapping`
    rates: np.ndarray  # (8, n) accelerations, m/s² or 1/s², rows START … of `radau5_step`
    speeds: np.ndarray  # (3, n) of the stages, m/s or 1/s
    slopes: np.ndarray  # (3, n) rates of the shifts of the stages, m/s or rad/s
    shifts: np.ndarray  # (3, n) from the start of the step to the stages, m or rad
    steps: np.ndarray  # (3, n) corrections of the stages by an iteration, m/s² or 1/s²
    momenta: np.ndarray  # (3, n) M u of the stages, N s or N m s
    missing: np.ndarray  # (n,) forces missing in the equations of motion, N or N m
    powers: np.ndarray  # (3,) of drivers and loads that store no energy, at the stages, W
    load_powers: np.ndarray  # (5, K) of each load whose work is kept: NOW, BEHIND, stages; W
    rest: np.ndarray  # (3, n) forces missing in the stages, along the free motions, scaled
    motions: np.ndarray  # (3, n, n) the free speeds at the stages, scaled
    matrices: np.ndarray  # (3, n, n) of the free motions, scaled: MASS_LAYER, DAMPING_LAYER, STIFFNESS_LAYER
    complex: np.ndarray  # (n, n) factors of the complex matrix
    real_part: np.ndarray  # (n,) right side and solution of the real matrix, scaled
    complex_part: np.ndarray  # (n,) and of the complex one, scaled
    newton: Work  # whose `reduced` is the real matrix
    states: np.ndarray  # (3, s) states of signals at the stages, SI units
    state_rates: np.ndarray  # (5, s) and their rates, 1/s, rows START, stages and BEHIND_STEP
