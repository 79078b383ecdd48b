"""One file per constraint type: residual, Jacobian rows, acceleration right-hand side.

`row` is c["first_row"], the first equation of constraint c; arrays and units are those of
`kernels.kinematics`.  With b bodies, n = 7 b coordinates and m equations:

- q (n,), qd (n,), qdd (n,): coordinates, velocities, accelerations
- rotations (3, b, 3, 3): A (b, 3, 3), Ad (b, 3, 3), Add (b, 3, 3), which are rotation matrices, their rates,
  and second derivatives without q̈
- phi (m,), phi_q (m, 14), nu (m,), gamma (m,): residual, Jacobian, right-hand sides
- u_i (3,): a vector fixed to body i, body axes; c () may also be a record of another dtype with C, B and A
"""
