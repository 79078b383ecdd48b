"""Constraint equations of YOUNG mechanisms, Newton's method and continuation.

Arrays that kernels here share, for b bodies, n = 7 b coordinates, m equations (m = n where they are solved)
and the screw joints.  Symbols are those of Young (1996); vectors are in global axes unless stated.

- q (n,): x, y, z, m, and e0, e1, e2, e3 body by body; qd (n,), qdd (n,): its time derivatives
- A (b, 3, 3): body to global axes; Ad (b, 3, 3): its rate, 1/s; Add (b, 3, 3): its second derivative but for
  what q̈ adds, 1/s²; rotations (3, b, 3, 3): these three
- constraints (k,): CONSTRAINT records of `model.arrays.kinematic`; c is one of them
- phi (m,): Φ, m or 1; phi_q (m, 14): Φ_q, by the coordinates of the row's body i, then of its body j
- row (14,): one row of phi_q
- nu (m,): -∂Φ/∂t, the right-hand side of Φ_q q̇ = ν; gamma (m,): that of Φ_q q̈ = γ
- u_i (3,), u_j (3,): vectors fixed to bodies i and j, in their body axes
- expected (screws,): angles expected, rad, which decide on whole turns; a float where it is one angle
- motion (screws, 3): angle, its rate and its second rate, rad, s
- state (3, n): coordinates, velocities, accelerations
- clock (6,): numbers of the continuation in the places that `continuation` names
"""
