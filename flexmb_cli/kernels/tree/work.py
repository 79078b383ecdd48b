"""Work space of the tree recursion, allocated once a run: one record a frame, one a coordinate.

Vectors in inertial axes.  An articulated inertia relates the angular and linear acceleration
(al, a) of a frame's origin to the moment and force (n, f) that give it:

    n = J al + H a + p_n,   f = Hᵀ al + M a + p_f

and is stored as 21 numbers: J (xx xy xz yy yz zz), H row by row, M (as J).
"""

import numpy as np

J_, H_, M_ = 0, 6, 15

FRAME_WORK = np.dtype(
    [
        (
            "hinge_axes",
            np.float64,
            9,
        ),  # S_j TD_k, axes of P_k; of a node frame the axes of its slopes, row by row
        ("axes", np.float64, 9),  # S_k, axes of O_k
        ("position", np.float64, 3),  # p_k, m
        ("offset", np.float64, 3),  # rho_k, from the parent's origin, m
        ("angular", np.float64, 3),  # w_k, rad/s
        ("velocity", np.float64, 3),  # v_k, m/s
        ("remainder", np.float64, 6),  # what the hinge adds to (al, a) by known terms, rad/s², m/s²
        ("inertia", np.float64, 21),  # articulated inertia, kg m², kg m, kg
        ("bias", np.float64, 6),  # p_n, p_f, N m, N
        ("acceleration", np.float64, 6),  # al, a, rad/s², m/s²
        ("unit_force", np.float64, 6),  # bias of the unit forces, N m, N
        ("response", np.float64, 6),  # (al, a) by the unit forces alone, rad/s², m/s²
    ]
)

COORDINATE_WORK = np.dtype(
    [
        ("held", np.int64),  # its acceleration is given throughout
        ("locked", np.int64),  # its acceleration is given in this solution, its effort follows
        ("rate", np.float64),  # acceleration: y', m/s² or rad/s²
        ("effort", np.float64),  # internal forces, springs, motors along it, N or N m
        ("direction", np.float64, 3),  # axis of a hinge coordinate, unit vector
        ("coupling", np.float64, 6),  # inertia times direction, kg m², kg m or kg
        ("pivot", np.float64),  # inertia along it while all that hangs on it is free, kg or kg m²
        ("unit_effort", np.float64),  # effort along it among the unit forces, N or N m
        ("drive", np.float64),  # effort less the bias force, N or N m; in the end what locks a locked one
        ("response", np.float64),  # acceleration by the unit forces alone, m/s² or rad/s²
    ]
)


def tree_work(frames: int, coordinates: int) -> tuple[np.ndarray, np.ndarray]:
    """Records for so many frames and coordinates; frame 0 stays the inertial frame at rest."""
    work = np.zeros(frames, FRAME_WORK)
    work["axes"][0] = np.eye(3).ravel()
    return work, np.zeros(coordinates, COORDINATE_WORK)
