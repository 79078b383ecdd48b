"""What CONTRIBUTING.md tells one to write for a joint, a card, quantities, an integrator and so on."""

# (a) A point on a plane, and one on a line, of the other body.
JOINT = {
    "flexmb_cli/model/joints.py": [
        (
            '    JointType("revolute-spherical",',
            '    JointType("point on plane", 0, 1, (*_P, "Q_i"), meets=False),\n'
            '    JointType("point on line", 0, 2, (*_P, "Q_i"), coordinates=(STROKE,)),\n',
        )
    ],
    "flexmb_cli/model/arrays/node_joints.py": [
        (
            '    "revolute-spherical": (_in_plane,',
            '    "point on plane": (_in_plane,),\n    "point on line": (_on_axis,),\n',
        )
    ],
    "flexmb_cli/dialects/vsdf/__init__.py": [
        (
            '        "RSPH": "revolute-spherical",',
            '        "PLAN": "point on plane",\n        "LINE": "point on line",\n',
        )
    ],
}
# The plane between points in the axes of their bodies, by the kernels of kinematics: a file besides these.
ONPLANE = '''"""Point on a plane: P_j stays in the plane through P_i across s_i.  Young (1996), (4.4)."""

from ..._jit import kernel
from ..joint_primitives import n2_acceleration, n2_jacobian, n2_residual

EQUATIONS = 1


@kernel
def residual(c, q, A, phi):
    """Fill phi[row], m."""
    phi[c["first_row"]] = n2_residual(c, c["s_i"], q, A)


@kernel
def jacobian(c, q, A, phi_q):
    """Fill a row of phi_q (equations, 14)."""
    n2_jacobian(c, c["s_i"], q, A, phi_q[c["first_row"]])


@kernel
def acceleration(c, q, qd, rotations, gamma):
    """Fill gamma[row]."""
    gamma[c["first_row"]] = n2_acceleration(c, c["s_i"], q, qd, rotations)
'''
JOINT_OF_POINTS = {
    "flexmb_cli/kernels/kinematics/constraints.py": [
        ("    normalisation,\n    revolute,", "    onplane,\n"),
        ("\n\n@kernel\ndef residual(", "ONPLANE = 11\n"),
        (
            "        elif kind == SIMPLIFIED:\n            simplified.residual(",
            "        elif kind == ONPLANE:\n            onplane.residual(c, q, A, phi)\n",
        ),
        (
            "        elif kind == SIMPLIFIED:\n            simplified.jacobian(",
            "        elif kind == ONPLANE:\n            onplane.jacobian(c, q, A, phi_q)\n",
        ),
        (
            "        elif kind == DRIVER:\n            driver.acceleration(",
            "        elif kind == ONPLANE:\n            onplane.acceleration(c, q, qd, rotations, gamma)\n",
        ),
    ],
    "flexmb_cli/model/joints.py": [
        (
            ")\n\n# Joints between nodes, besides those",
            '    JointType("onplane", 11, 1, _P + _Q, (("s_i · d", True, ("s_i",)),), meets=False),\n',
        )
    ],
}
PAYLOAD = '''def _loaded(rigid: RigidMass, mass: float, r: np.ndarray) -> RigidMass:
    """Return the mass properties with a point mass at r, by Steiner's theorem."""
    total, d = rigid.mass + mass, r - np.array(rigid.centre)
    x, y, z = np.array(rigid.centre) + mass / total * d
    inertia = rigid.inertia + rigid.mass * mass / total * (d @ d * np.eye(3) - np.outer(d, d))
    return RigidMass(total, (float(x), float(y), float(z)), inertia)


'''
# (b) By file: where in it, and what is put there.  Gravity by its strength alone, downwards; a point mass
# at a node of a rigid body.
CARD = {
    "flexmb_cli/dialects/vsdf/cards/joints_and_loads.py": [
        (
            '    card("GRAV ',
            '    card("DOWN weight single", "DOWN", Column("g", "gravity along -z", "m/s^2")),\n',
        )
    ],
    "flexmb_cli/dialects/vsdf/build.py": [
        (
            "    return VsdfModel(",
            '    if weight := values.record("weight"):\n        g = (0.0, 0.0, -float(weight["g"]))\n',
        )
    ],
}
CARD_OF_BODIES = {
    "flexmb_cli/dialects/vsdf/cards/bodies.py": [
        (
            '    card(\n        "NODE node list",\n',
            '    card("PAYL payload list", "payload {}", BODY, whole_column("node", "node", None),\n'
            '         Column("mass", "mass", "kg", default=None), bodies="RIGD"),\n',
        )
    ],
    "flexmb_cli/dialects/vsdf/bodies.py": [
        (
            "    return VsdfBody(record.subject, **pose, rigid=mass",
            '    for payload in values.of_body("payload", k) if mass else ():\n'
            '        mass = _loaded(mass, float(payload["mass"]), nodes[payload["node"]])\n',
        ),
        ("def _rigid_mass(", PAYLOAD),
    ],
}
# (c) A field and a property of every analysis, by file: the lines before which they are put.  Their names
# are none that a contributor would choose, since the recipes are tried beside what was contributed.
MAGNITUDE = '''    @property
    def {}(self) -> np.ndarray:
        """Magnitude of the {} of each body (T, bodies), {}."""
        found: np.ndarray = np.linalg.norm(self.{}, axis=-1)
        return found

'''
SPEED = MAGNITUDE.format("pace", "velocity", "m/s", "velocity")
TURNING = (
    "\n" + MAGNITUDE.format("whirl", "angular velocity", "rad/s", "angular_velocity").rstrip("\n") + "\n"
)
LAGRANGIAN = '''    @property
    def surplus(self) -> np.ndarray:
        """Kinetic less potential energy (T,), J."""
        found: np.ndarray = self.kinetic - self.potential
        return found

'''
PROPERTY = "    @property\n    def total(self)"
BODY = '("body/body",)'
STORED = '    "{}": Series("{}", {}, "{}", "{}"),\n'
STORED_SPEED = STORED.format("pace", "body/pace", BODY, "m/s", "magnitude of the velocity")
STORED_MOMENTUM = STORED.format("impetus", "system/impetus", '("xyz",)', "kg m/s", "momentum")
STORED_REACH = STORED.format("afar", "body/afar", BODY, "m", "distance from the origin")
STORED_TURNING = STORED.format("whirl", "body/whirl", BODY, "rad/s", "magnitude of its turning")
MOMENTUM = "    impetus: np.ndarray  # (T, 3) of masses at the origins of their bodies, kg m/s\n"
QUANTITY = {
    "flexmb_cli/solvers/kinematics/rows.py": [
        ("    constraint_residual: np", "    afar: np.ndarray  # (T, n) distance from the origin, m\n"),
        ("        constraint_residual=", "        afar=np.linalg.norm(q[:, :, :3], axis=-1),\n"),
        ("\n\ndef rows_of(", "\n" + TURNING.removesuffix("\n")),
    ],
    "flexmb_cli/results/hdf5/kinematic.py": [
        ('    "constraint_residual": Series(', STORED_REACH + STORED_TURNING)
    ],
    "flexmb_cli/solvers/constrained/rows.py": [
        ("    applied_power: np", MOMENTUM),
        (
            "        applied_power=",
            "        impetus=np.einsum(\n"
            '            "b,tbi->ti",\n'
            "            [item.mass for item in model.masses],\n"
            "            motion.velocity[:, [item.body for item in model.masses]],\n"
            "        ),\n",
        ),
        (PROPERTY, LAGRANGIAN),
    ],
    "flexmb_cli/results/hdf5/dynamic.py": [
        (
            '    "kinetic": Series(',
            STORED_MOMENTUM + STORED.format("surplus", "energy/surplus", "()", "J", "kinetic - potential"),
        )
    ],
    "flexmb_cli/solvers/tree/rows.py": [
        ("    closure_force: np.ndarray  # (T, C, 3) on body a of each closure, opp", MOMENTUM),
        (
            "        constraint_residual=",
            '        impetus=np.einsum("b,tbi->ti", [b.mass for b in tree.bodies], motion["velocity"]),\n',
        ),
        (PROPERTY, SPEED),
    ],
    "flexmb_cli/results/hdf5/tree.py": [('    "kinetic": Series(', STORED_SPEED + STORED_MOMENTUM)],
    "flexmb_cli/solvers/constrained/flexible_rows.py": [
        ("    amplitude: tuple", MOMENTUM),
        (
            "        amplitude=",
            '        impetus=np.einsum("b,tbi->ti", [b.m for b in mechanism.bodies], u[..., :3]),\n',
        ),
        (PROPERTY, SPEED),
    ],
    "flexmb_cli/results/hdf5/flexible.py": [('    "kinetic": Series(', STORED_SPEED + STORED_MOMENTUM)],
}
# (d) The classical method of order 4, besides a file of its kernels.
KERNELS = {"flexmb_cli/kernels/integrators/kutta/rk4.py": "tests/kernels/integrators/rk4.py"}
INTEGRATOR = {
    "flexmb_cli/kernels/signatures.py": [
        (
            '    "alpha": {',
            '    "rk4": {\n        "integrators.kutta.rk4.integrate_rows": '
            '"int System Work Integration Report int",\n    },\n',
        )
    ],
    "flexmb_cli/model/integrators.py": [
        (
            "}\nMETHOD_OPTIONS",
            '    "RK4": IntegratorType("rk4", "Kutta", "kutta.rk4", 1e-8, given_step=True),\n',
        )
    ],
}
# (f) Lines of row, column (from 1) and value.
READER = '''"""Lines of row, column and value."""

import numpy as np

from .matrix_file import MatrixFile


def read_triples(path):
    """Return the matrix of a file."""
    rows, columns, values = np.loadtxt(path, ndmin=2).T
    size = int(max(rows.max(), columns.max()))
    return MatrixFile(size, rows.astype(int) - 1, columns.astype(int) - 1, values, True)
'''
FORMAT = {
    "flexmb_cli/fe/formats/formats.py": [
        ('    "MM": MatrixFormat(', '    "TRI": MatrixFormat("triples:read_triples"),\n')
    ]
}
# (h) A torque that grows with the square of the rate, and one with the cube of the stretch.
LAW = {
    "flexmb_cli/model/laws.py": [
        (
            ")\nPARTS_OF_FRAMES",
            ",\n    Law(\n"
            '        "SQUARE",\n'
            "        11,\n"
            '        (Parameter("drag", "{effort} per rate^2", 1, -2, 2, signed=True, resists=True),),\n'
            "        (At, Line),\n"
            "    ),\n"
            "    Law(\n"
            '        "CUBE",\n'
            "        12,\n"
            "        (\n"
            '            Parameter("stiffness", "{effort} per cube of the stretch", 1, -3),\n'
            '            Parameter("rest", "rest {coordinate}", 0, 1, 0, 0.0, signed=True, counted=True),\n'
            "        ),\n"
            "    )",
        )
    ],
    "flexmb_cli/kernels/laws.py": [
        ("# Columns of the answers.", "SQUARE, CUBE = 11, 12\n"),
        (
            '    if law["shape"] == CABLE:\n',
            '    if law["shape"] == SQUARE:\n'
            "        drag = c[0]\n"
            "        answer[STIFFNESS], answer[DAMPING], answer[ENERGY] = 0.0, 2.0 * drag * abs(v), 0.0\n"
            "        return -drag * abs(v) * v, 0.0\n"
            '    if law["shape"] == CUBE:\n'
            "        k, s = c[0], x - c[1]\n"
            "        answer[STIFFNESS], answer[DAMPING] = 3.0 * k * s * s, 0.0\n"
            "        answer[ENERGY] = 0.25 * k * s**4\n"
            "        return -k * s**3, -k * s**3\n",
        ),
    ],
}

# A body of 2 kg that falls; the method of order 8 has no error in a parabola.
DECK = """\
VSDF A BODY THAT FALLS
BODY
    1 RIGD
RIGI
    1       2.0       0.0       0.0       0.0
       0.1       0.2       0.3       0.0       0.0       0.0
DOWN
       9.5
TIME
       0.5       0.1
INTG
 RK45    1.0E-8
END
STAR
STOP
"""

# The mass centre on the plane through the origin whose normal is (1, 0, 1).
PLANE = """\
NODE
    0    1       0.0       0.0       0.0
    0    2       1.0       0.0       1.0
    1    3       0.0       0.0       0.0
JOIN
    1 PLAN    0    1    2    1    3
TIME
"""

# A bead on a wire that falls at 45°, with a damper of 1.5 N s/m along it.
BEAD = """\
NODE
    0    1       0.0       0.0       0.0
    0    2       1.0       0.0      -1.0
    1    3       0.0       0.0       0.0
JOIN
    1 LINE    0    1    2    1    3
JSPR
    1       0.0       1.5
TIME
"""
# A point mass of 6 kg 0.4 m below the joint, at whose height the body's 2 kg are.
PENDULUM = """\
NODE
    0    1       0.0       0.0       0.0
    0    2       0.0       1.0       0.0
    1    3       0.0       0.0       0.0
    1    4       0.0       1.0       0.0
    1    5       0.4       0.0       0.0
PAYL
    1    5       6.0
JOIN
    1 REVO    0    1    2    1    3    4
TIME
"""

# Body 2 turns about z at 3 rad/s, its origin 0.5 m from the axis.
ROTOR = """2 1 0 0 0 1 0 0 0 0 0 1
0 0 0 1 0 0 0
0.5 0 0 1 0 0 0
2 6 0 3 0
1 2 0 0 0 -0.5 0 0 0 0 1 -0.5 0 1
1 0 0 0 0 0 0
0 0.2 0.1
"""
# A mass of 1.5 kg falls.
FALLING = """2 0 0 0 0 0 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 0 0 0 0 0 0
0 0.2 0.1
DYNAMICS forward
MASS 2 1.5 0 0 0 1 1 1
GRAVITY 0 -8 0
END
"""
# A wheel with 0.8 kg m2 about its joint begins at 5 rad/s.
WHEEL = """2 0 0 0 0 1 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 2 0 0 0 0 0 0 0 0 1 0 0 1
1 0 0 0 0 0 0
0 0.4 0.1
DYNAMICS forward
MASS 2 2 0 0 0 0.8 0.8 0.8
ELEMENTS
  START at=1.angle rate=5
"""
