"""A rigid mechanism with loads as a Python script for Exudyn.

Each body stands in the script by its mass centre; positions and speeds are those at the start that flexmb
has assembled, so that joints are closed to round-off.  Exudyn's reference manual (MainSystem functions
Create…) is the source of the calls; its connectors resist what their functions return.  Angles are 0 in
Exudyn where the script places the bodies; strokes are distances.
"""

import re
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ...errors import Fault, ModelError
from ...model.arrays.element_table import coordinates_of_joints
from ...model.joint_elements import JointElements
from ...model.laws import (
    BUSHING,
    CABLE,
    DRIVING,
    FRICTION,
    MOTOR,
    SPRING,
    STOP,
    At,
    Cam,
    Element,
    Push,
    is_angle,
)
from ...model.loads import DynamicModel
from ...model.mechanism import GROUND
from ...model.time_functions import SIGNAL, MotionFunction
from ...model.vectors import rotation_matrix
from .exudyn_functions import FUNCTIONS, function_text
from .exudyn_joints import HELD, Position, independent_equations, joint_frames

HEAD = '''"""{title}, written by flexmb for Exudyn 1.13 or later.  SI units.

Run it: results are positions of the body frames at the report times, in the file {title}-exudyn.csv.
`flexmb diff {title}-exudyn.csv RESULT.h5 --atol 1e-6` compares them with flexmb's.
"""

import math
from bisect import bisect_right

import exudyn as exu
import numpy as np
from exudyn.utilities import RigidBodyInertia


def shape(points, triangles):
    """A surface for pictures: corners and the numbers of those of each triangle."""
    colours = [0.4, 0.5, 0.6, 1.0] * (len(points) // 3)
    return dict(type="TriangleList", points=points, colors=colours, triangles=triangles)


SC = exu.SystemContainer()
mbs = SC.AddSystem()
ground = mbs.CreateGround({ground})
gravity = {gravity}
# Time of the deck at the start.
BEGIN = {begin!r}
'''
TAIL = """
END, ROWS = {end!r}, {rows!r}
COLUMNS = {columns!r}
# Origins of the body frames, from the mass centres.
ORIGINS = {origins!r}
sensors = [
    mbs.AddSensor(dict(sensorType="Body", bodyNumber=body, storeInternal=True, writeToFile=False,
                       outputVariableType=exu.OutputVariableType.Position, localPosition=origin))
    for body, origin in zip(bodies, ORIGINS)
]
mbs.Assemble()
settings = exu.SimulationSettings()
settings.timeIntegration.endTime = END
settings.timeIntegration.newton.relativeTolerance = 1e-10
settings.timeIntegration.newton.absoluteTolerance = 1e-12
# The trapezoidal rule with constraints of velocities: no numerical damping.
settings.timeIntegration.generalizedAlpha.spectralRadius = 1
settings.timeIntegration.generalizedAlpha.useNewmark = True
settings.timeIntegration.generalizedAlpha.useIndex2Constraints = True
settings.solution.file.write = False
settings.solution.sensors.writePeriod = END / (ROWS - 1)
settings.timeIntegration.verboseMode = 0


def solve(steps):
    # Times and positions by this number of steps.
    settings.timeIntegration.numberOfSteps = steps
    mbs.SolveDynamic(settings)
    table = [mbs.GetSensorStoredData(sensor) for sensor in sensors]
    return np.hstack([table[0][:, :1], *(column[:, 1:] for column in table)])


# The error of this rule has even powers of the step only: two solutions give one whose error falls to a
# sixteenth with half the steps (Richardson).  Its change is the estimate of its error.
TOLERANCE, MOST_STEPS = {tolerance!r}, {most!r}
steps = {steps!r}
coarse, rows, error = solve(steps), None, np.inf
while error > TOLERANCE and steps < MOST_STEPS:
    steps *= 2
    fine = solve(steps)
    better = fine + (fine - coarse) / 3
    error = np.inf if rows is None else np.abs(better - rows).max()
    coarse, rows = fine, better
rows[:, 0] += BEGIN
np.savetxt("{title}-exudyn.csv", rows, delimiter=",", fmt="%.17g", header=COLUMNS, comments="")
print(f"{{steps}} steps, estimated error of positions {{error:.1e}} m")
if error > TOLERANCE:
    raise SystemExit(f"the error is above {{TOLERANCE:.1e}} m: allow more than {{MOST_STEPS}} steps")
"""
DEFINITIONS = '''

def pushed(depth, rate, k, b):
    """Force of a stop, or pull of a cable: Hunt and Crossley (1975), exponent 1."""
    return k * depth * max(0.0, 1.0 + b * rate) if depth > 0 else 0.0


def cable(mbs, t, number, stretch, rate, k, b, force):
    return pushed(stretch, rate, k, b)


def stops(lower, upper, k, b):
    return lambda mbs, t, number, x, v, *_: pushed(x - upper, v, k, b) - pushed(lower - x, -v, k, b)


def spring(k, rest, c, preload, curve=None, damper=None):
    def effort(mbs, t, number, x, v, *_):
        push = preload + k * (x - rest) + c * v
        return push + (curve(x - rest) if curve else 0.0) + (damper(v) if damper else 0.0)

    return effort


def motor(function):
    return lambda mbs, t, *_: -function(t + BEGIN)


def factor(function):
    return lambda mbs, t, load: np.array(load) * function(t + BEGIN)


def slide(bodies, places, axis, **law):
    markers = [
        mbs.AddMarker(dict(markerType="BodyRigid", bodyNumber=body, localPosition=place))
        for body, place in zip(bodies, places)
    ]
    spring = dict(objectType="ConnectorLinearSpringDamper", markerNumbers=markers, axisMarker0=axis)
    mbs.AddObject(spring | law)


'''
_REFUSED = {
    "drivers": (
        "drivers of joints do not convert: Exudyn has them without its rule of velocities",
        "RESULT-067",
    ),
    "driven": ("drivers by functions do not convert", "RESULT-069"),
    "supports": ("supports by functions do not convert", "RESULT-070"),
    "couplings": ("couplings of joint coordinates do not convert", "RESULT-072"),
    "curves": ("points on curves do not convert", "RESULT-130"),
    "generals": ("lines JOINT of this type do not convert", "SOLVE-185"),
    "switches": ("lines CATCH and RELEASE do not convert", "SOLVE-214"),
    "rolls": ("rolling without slip does not convert", "RESULT-140"),
}
_REFUSED_LAWS = {
    BUSHING: (
        "bushings do not convert: Exudyn's have other angles if a body turns about several axes",
        "RESULT-071",
    ),
    FRICTION: ("friction does not convert: Exudyn's has no normal force of the joint", "RESULT-073"),
}
LINK = "spherical-spherical"
# Steps of a report interval: of the first solution, and of the last that the script tries.
FIRST_STEPS, LAST_STEPS = 10, 10 * 2**10
POSITION_ERROR = 1e-7  # m
_NO_WORD = re.compile(r"""[\\"'\x00-\x1f]""")


def exudyn_script(
    model: DynamicModel, start: Position, name: str, later: Sequence[Position] = (), dofs: int | None = None
) -> str:
    """Return the script.

    `start`: "r" (bodies, 3) in m, Euler parameters "p" (bodies, 4), "v" and "omega" (bodies, 3), global axes.
    `later`: "r" and "p" at later times, which distinguish a singular start from repeated equations.
    `dofs`: degrees of freedom that the script must leave, if known.
    Raises ModelError for what is not converted.
    """
    # The name stands in texts of the script: with a quotation mark it could be any statement.
    name = _NO_WORD.sub("_", name)
    faults = list(_foreign(model))
    if faults:
        raise ModelError(faults)
    time, placed = model.mechanism.time, _Placed(model, start)
    links = model.elements.composites
    held, independent = independent_equations(model.mechanism, links, [start, *later])
    left = 6 * len(placed.numbers) - sum(map(sum, held)) - sum(independent)
    if dofs not in (None, left):
        message = (
            f"the script would have {left} degrees of freedom, the deck has {dofs}: some equations nearly "
            "repeat others; give the axes of loops with more digits, or begin away from a singular position"
        )
        raise ModelError([Fault("error", message, id="RESULT-085")])
    lines = [_head(placed, name) + FUNCTIONS + DEFINITIONS, "bodies = []"]
    lines += [*placed.bodies(), *placed.joints(held), *placed.loads(), *placed.elements(independent)]
    intervals = max(time.rows - 1, 1)
    return "\n".join(lines) + TAIL.format(
        title=name,
        end=time.last - time.start,
        rows=time.rows,
        columns=",".join(["time [s]", *placed.columns()]),
        origins=[[0.0 - float(x) for x in placed.centre[body]] for body in placed.numbers],
        steps=FIRST_STEPS * intervals,
        most=LAST_STEPS * intervals,
        tolerance=POSITION_ERROR,
    )


def _head(placed: "_Placed", name: str) -> str:
    begin, gravity = placed.model.mechanism.time.start, _list(placed.model.gravity)
    shapes = placed.graphics([GROUND, *sorted(placed.still - {GROUND})])
    return HEAD.format(title=name, gravity=gravity, begin=begin, ground=shapes.removeprefix(", "))


def _foreign(model: Any) -> Iterator[Fault]:
    """Yield the faults of what cannot be converted."""
    mechanism = model.mechanism
    for joint in mechanism.joints:
        if joint.kind not in HELD:
            message = "only spherical, revolute, cylindrical and translational joints convert"
            yield Fault("error", message, joint.place, joint.name, id="RESULT-053")
    for item in (*mechanism.simplified, *mechanism.distances, *mechanism.drivers):
        message = "drivers and constraints of single coordinates do not convert"
        yield Fault("error", message, item.place, item.name, id="RESULT-054")
    heavy, still = {item.body for item in model.masses}, {item.body for item in mechanism.grounds}
    for k, body in enumerate(mechanism.bodies):
        if k not in heavy | still:
            message = "Exudyn needs a mass for every moving body"
            yield Fault("error", message, body.place, body.name, id="RESULT-055")
    yield from _foreign_elements(model.elements)


def _foreign_elements(elements: JointElements) -> Iterator[Fault]:
    """Yield the faults of elements that do not convert."""
    for kind, (message, name) in _REFUSED.items():
        for item in getattr(elements, kind):
            yield Fault("error", message, item.place, item.name, id=name)
    for force in elements.forces:
        if refusal := _refused(force):
            message, name = refusal
            yield Fault("error", message, force.place, force.name, id=name)
    for composite in elements.composites:
        if composite.kind != LINK:
            message = f"a {composite.kind} joint does not convert"
            yield Fault("error", message, composite.place, composite.name, id="RESULT-075")


def _refused(item: Element) -> tuple[str, str] | None:
    """Return why a force element does not convert, and the identifier of the fault."""
    if isinstance(item.measure, Cam):
        return "followers of cams do not convert", "RESULT-086"
    if any(isinstance(value, MotionFunction) and value.kind == SIGNAL for value in item.values):
        return "signals do not convert", "RESULT-180"
    if item.law in (SPRING, CABLE, STOP, *DRIVING):
        return None
    return _REFUSED_LAWS.get(item.law, (f"the law {item.law.word} does not convert", "RESULT-031"))


class _Placed:
    """The parts of the model in global axes at the start."""

    def __init__(self, model: DynamicModel, start: dict[str, np.ndarray]):
        self.model, self.start = model, start
        self.A = [rotation_matrix(p) for p in start["p"]]
        self.still = {GROUND, *(item.body for item in model.mechanism.grounds)}
        self.centre = np.zeros((len(self.A), 3))
        moving = sorted(mass.body for mass in model.masses if mass.body not in self.still)
        self.numbers = {body: number for number, body in enumerate(moving)}
        for mass in model.masses:
            self.centre[mass.body] = mass.centre

    def bodies(self) -> Iterator[str]:
        """Yield a line for every moving body."""
        for mass in sorted(self.model.masses, key=lambda mass: mass.body):
            k = mass.body
            if k in self.still:
                continue
            xx, yy, zz, xy, yz, zx = mass.inertia
            tensor = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]
            arm = self.A[k] @ self.centre[k]
            velocity = self.start["v"][k] + np.cross(self.start["omega"][k], arm)
            yield (
                f"bodies.append(mbs.CreateRigidBody(name={self.model.mechanism.bodies[k].name!r}, "
                f"inertia=RigidBodyInertia(mass={mass.mass!r}, inertiaTensor=np.array({tensor!r})), "
                f"nodeType=exu.NodeType.RotationEulerParameters, gravity=gravity, "
                f"referencePosition={_list(self.start['r'][k] + arm)}, "
                f"referenceRotationMatrix=np.array({[list(map(float, row)) for row in self.A[k]]!r}), "
                f"initialVelocity={_list(velocity)}, initialAngularVelocity={_list(self.start['omega'][k])}"
                f"{self.graphics([k])}))"
            )

    def columns(self) -> Iterator[str]:
        """Yield the headings of the positions, as results of flexmb have them."""
        for body in self.numbers:
            yield from (f"body.{body + 1}.{axis} [m]" for axis in "xyz")

    def graphics(self, bodies: list[int]) -> str:
        """Return the argument for the shapes of bodies, from the mass centre or global; "" without any."""
        shapes = [shape for shape in self.model.mechanism.shapes if shape.body - 1 in bodies]
        surfaces = []
        for shape in shapes:
            k = shape.body - 1
            points = shape.vertices
            if k in self.still:
                points = self.start["r"][k] + points @ self.A[k].T
            elif k != GROUND:
                points = points - self.centre[k]
            triangles = shape.triangles.ravel().tolist()
            surfaces.append(f"shape({points.ravel().tolist()!r}, {triangles!r})")
        return f", graphicsDataList=[{', '.join(surfaces)}]" if surfaces else ""

    def joints(self, held: list[tuple[int, ...]]) -> Iterator[str]:
        """Yield a line for every joint; `held`: the motions that each prevents."""
        mechanism = self.model.mechanism
        frames = joint_frames(mechanism, self.start)
        for joint, frame, axes in zip(mechanism.joints, frames, held, strict=True):
            place = _list(self._at(joint.i, joint.P_i))
            pair = f"itemNumbers=[{self._word(joint.i)}, {self._word(joint.j)}], position={place}"
            axis = f"axis={_list(frame[:, 2])}"
            if axes != HELD[joint.kind]:
                yield f"# {joint.name}, without the equations that repeat those of other joints:"
                yield _generic(pair, frame, axes)
            elif joint.kind == "spherical":
                yield f"mbs.CreateSphericalJoint({pair})"
            elif joint.kind == "revolute":
                yield f"mbs.CreateRevoluteJoint({pair}, {axis})"
            elif joint.kind == "translational":
                yield f"mbs.CreatePrismaticJoint({pair}, {axis})"
            else:
                yield _generic(pair, frame, axes)

    def loads(self) -> Iterator[Any]:
        """Yield a line for every spring, force and torque."""
        for item in self.model.springs:
            i, j, P_i, P_j = item.measure
            ends = ", ".join(
                f"localPosition{n}={_list(self._local(body, point))}"
                for n, (body, point) in enumerate(((i, P_i), (j, P_j)))
            )
            yield (
                f"mbs.CreateSpringDamper(itemNumbers=[{self._word(i)}, {self._word(j)}], {ends}, "
                f"referenceLength={item['rest']!r}, stiffness={item['stiffness']!r}, "
                f"damping={item['damping']!r})"
            )
        for force in self.model.forces:
            if force.body not in self.still:
                yield (
                    f"mbs.CreateForce(itemNumber={self._word(force.body)}, loadVector={_list(force.force)}, "
                    f"localPosition={_list(self._local(force.body, force.point))}, "
                    f"bodyFixed={bool(force.following)}{_factor(force)})"
                )
        for torque in self.model.torques:
            if torque.body not in self.still:
                yield (
                    f"mbs.CreateTorque(itemNumber={self._word(torque.body)}, "
                    f"loadVector={_list(torque.torque)}, bodyFixed={bool(torque.following)}{_factor(torque)})"
                )

    def elements(self, independent: list[bool]) -> Iterator[str]:
        """Yield definitions and a line for every element; `independent`: links that repeat no equation."""
        elements = self.model.elements
        for item in elements.forces:
            if isinstance(item.measure, Push):
                if item.measure.j not in self.still:
                    yield self._push(item.measure, item["function"])
                continue
            if isinstance(item.measure, At):
                yield self._at_joint(item.measure, self._law(item.since(self._since(item.measure))))
                continue
            law = "referenceLength={1!r}, stiffness={0!r}, damping={2!r}".format(*item.values)
            last = "springForceUserFunction=cable" if item.law is CABLE else f"force={item['preload']!r}"
            if item.law is SPRING and (item["curve"] or item["damper"]):
                last = f"springForceUserFunction={_spring_text(item.with_values(rest=0.0))}"
            yield f"mbs.CreateSpringDamper({self._ends(item.measure)}, {law}, {last})"
        for link, needed in zip(elements.composites, independent, strict=True):
            call = f"mbs.CreateDistanceConstraint({self._ends(link)}, distance={link.size!r})"
            yield call if needed else f"# {link.name} repeats equations of others"

    def _law(self, item: Element) -> str:
        """The law of a spring or of stops in a joint."""
        effort = "torque" if item.turning else "force"
        if item.law is STOP:
            return f"spring{effort.capitalize()}UserFunction=stops({', '.join(map(repr, item.values))})"
        function = f"spring{effort.capitalize()}UserFunction"
        if item.law is MOTOR:
            return f"{function}=motor({function_text(item['function'])})"
        if item["curve"] or item["damper"]:
            return f"{function}={_spring_text(item)}"
        stiffness, rest, damping, preload, *_ = item.values
        return f"stiffness={stiffness!r}, damping={damping!r}, offset={rest!r}, {effort}={preload!r}"

    def _push(self, push: Push, function: MotionFunction) -> str:
        """A force or torque that follows a function of time."""
        call = "CreateTorque" if push.turning else "CreateForce"
        place = "" if push.turning else f"localPosition={_list(self._local(push.j, push.P_j))}, "
        return (
            f"mbs.{call}(itemNumber={self._word(push.j)}, loadVector={_list(push.direction)}, {place}"
            f"bodyFixed={bool(push.follows)}, loadVectorUserFunction=factor({function_text(function)}))"
        )

    def _since(self, item: Any) -> float:
        """Joint coordinate at the start, less Exudyn's: of angles 0, of strokes the advance of P_j."""
        joints = self.model.mechanism.joints
        names = [(each.joint, each.coordinate) for each in coordinates_of_joints(joints)]
        q = float(self.start["q"][names.index((item.joint, item.coordinate))])
        joint = joints[item.joint]
        if is_angle(item.coordinate):
            return q
        axis = self._turned(joint.i) @ np.array(joint.s_i, float) / np.linalg.norm(joint.s_i)
        return q - float((self._at(joint.j, joint.P_j) - self._at(joint.i, joint.P_i)) @ axis)

    def _pair(self, item: Any) -> str:
        return f"itemNumbers=[{self._word(item.i)}, {self._word(item.j)}]"

    def _ends(self, item: Any) -> str:
        ends = ((item.i, item.P_i), (item.j, item.P_j))
        places = [f"localPosition{n}={_list(self._local(*end))}" for n, end in enumerate(ends)]
        return ", ".join([self._pair(item), *places])

    def _at_joint(self, item: Any, law: str) -> str:
        """A spring and damper in the angle or the stroke of its joint."""
        joint = self.model.mechanism.joints[item.joint]
        axis = np.array(joint.s_i, float) / np.linalg.norm(joint.s_i)
        if is_angle(item.coordinate):
            place = f"position={_list(self._at(joint.i, joint.P_i))}"
            along = f"axis={_list(self._turned(joint.i) @ axis)}"
            return f"mbs.CreateTorsionalSpringDamper({self._pair(joint)}, {place}, {along}, {law})"
        bodies = f"[{self._word(joint.i)}, {self._word(joint.j)}]"
        places = [_list(self._local(*end)) for end in ((joint.i, joint.P_i), (joint.j, joint.P_j))]
        along = self._turned(joint.i) @ axis if self._word(joint.i) == "ground" else axis
        return f"slide({bodies}, [{', '.join(places)}], {_list(along)}, {law})"

    def _turned(self, body: int) -> np.ndarray:
        """Rotation matrix (3, 3) of a body or of the ground."""
        return np.eye(3) if body == GROUND else self.A[body]

    def _at(self, body: int, point: tuple[float, float, float]) -> np.ndarray:
        if body == GROUND:
            return np.array(point, float)
        return self.start["r"][body] + self.A[body] @ np.array(point)

    def _local(self, body: Any, point: Any) -> Any:
        """A point from the mass centre of a moving body, or global of one at rest."""
        if body in self.still:
            return self._at(body, point)
        return np.array(point) - self.centre[body]

    def _word(self, body: int) -> str:
        return "ground" if body in self.still else f"bodies[{self.numbers[body]}]"


def _factor(load: Any) -> str:
    """Return the argument for the function of time of a load, if it has one."""
    return "" if load.factor is None else f", loadVectorUserFunction=factor({function_text(load.factor)})"


def _spring_text(item: Element) -> str:
    """Return the law of a spring with functions."""
    numbers = [repr(float(item[name])) for name in ("stiffness", "rest", "damping", "preload")]
    functions = [f"{name}={function_text(item[name])}" for name in ("curve", "damper") if item[name]]
    return f"spring({', '.join([*numbers, *functions])})"


def _generic(pair: str, frame: np.ndarray, axes: tuple[int, ...]) -> str:
    """Return the line of a joint that holds `axes` of a frame; without any there is no joint."""
    if not any(axes):
        return "# none is left"
    return (
        f"mbs.CreateGenericJoint({pair}, "
        f"rotationMatrixAxes=np.array({[list(map(float, row)) for row in frame]!r}), "
        f"constrainedAxes={list(axes)!r})"
    )


def _list(values: np.ndarray | tuple[float, float, float]) -> str:
    return repr([float(value) for value in values])
