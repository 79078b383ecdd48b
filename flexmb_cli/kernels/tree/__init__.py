"""Kane's equations of trees.

Arrays that kernels here share, for F frames, NS coordinates, R closed directions and the hinges with three
rotations (balls).  Vectors are in inertial axes unless stated; units of coordinates are m and rad.

- q (NS,), y (NS,): coordinates and speeds; z (N,), dz (N,): state and its rates, see `motion`
- attitudes (balls, 4), rates (balls, 4): Euler parameters of the balls and their rates
- work (F,): FRAME_WORK records; s and parent are one each
- coordinates (NS,): COORDINATE_WORK records; c is one
- closures (R,): CLOSURE_ROW records; matrix (R, R): of the closed directions
- nodal_masses (k,): NODAL_MASS records; gravity (3,): m/s²
- I (21,): an articulated inertia, in the order of `work`
- matrices (k,): matrices of elastic bodies, flat; reach (NS, 2): places that count in their rows
- x (NS,), out (NS,), residual (NS,): accelerations, or efforts, along the coordinates
"""
