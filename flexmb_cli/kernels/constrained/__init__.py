"""Constrained equations of motion in absolute coordinates.

Arrays that kernels here share, for b bodies with E modal coordinates, n = 6 b + E speeds, m equations and
states of N numbers.  `System` and `Work` (`system`) say what their arrays hold.

- q (n + b,): r, global axes, m, and p of all bodies, then all η; qd (n + b,), qdd (n + b,): rates
- u (n,): speeds, v, global axes, m/s, and ω, body axes, rad/s, of all bodies, then all η̇; ud (n,): rates
- z (N,): state, q, u and the works of drivers and loads, J
- x (n,), y (n,): vectors of speeds, or of forces on them
- f (n,), forces (n,): forces on the speeds, N, N m or, for a mode, what does work on η̇
- phi (m,), nu (m,), gamma (m,): equations, right-hand sides of J u = ν and J u̇ = γ, in their units
- lam (m,): multipliers of scaled equations, N, or N m
- expected (angles,): angles expected, rad, which decide on whole turns
- loads (loads,): LOAD records; functions (functions,): FUNCTION records
"""
