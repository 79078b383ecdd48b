"""A YOUNG model whose joints turn about z in Exudyn, as rigid bodies in the plane."""

import math
import sys

import numpy as np

sys.exudynFast = True  # Exudyn's module without range checks; it looks here when it is imported


def planar_system(model):
    """Exudyn's system of a `DynamicModel` and the sensors of the origins of all bodies but the ground."""
    import exudyn as exu
    import exudyn.itemInterface as item

    mbs, mechanism = exu.SystemContainer().AddSystem(), model.mechanism
    ground = mbs.AddObject(item.ObjectGround())
    numbers, centres = {0: ground}, {0: np.zeros(3)}
    speeds = {entry.body: (entry.velocity, entry.angular) for entry in model.velocities}
    for mass in model.masses:
        body = mechanism.bodies[mass.body]
        angle, c = 2.0 * math.atan2(body.p[3], body.p[0]), np.array(mass.centre)
        arm = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]) @ c[:2]
        v, w = speeds.get(mass.body, (np.zeros(3), np.zeros(3)))
        place = [body.r[0] + arm[0], body.r[1] + arm[1], angle]
        speed = [v[0] - w[2] * arm[1], v[1] + w[2] * arm[0], w[2]]
        node = mbs.AddNode(item.NodeRigidBody2D(referenceCoordinates=place, initialVelocities=speed))
        rigid = item.ObjectRigidBody2D(physicsMass=mass.mass, physicsInertia=mass.inertia[2], nodeNumber=node)
        numbers[mass.body], centres[mass.body] = mbs.AddObject(rigid), c
        middle = mbs.AddMarker(item.MarkerBodyPosition(bodyNumber=numbers[mass.body]))
        weight = [mass.mass * g for g in model.gravity]
        mbs.AddLoad(item.LoadForceVector(markerNumber=middle, loadVector=weight))

    def end(body, point):
        """A marker at a point of a body, from the origin of its axes."""
        local = list(np.array(point) - centres[body])
        return mbs.AddMarker(item.MarkerBodyPosition(bodyNumber=numbers[body], localPosition=local))

    for joint in mechanism.joints:
        ends = [end(joint.i, joint.P_i), end(joint.j, joint.P_j)]
        mbs.AddObject(item.RevoluteJoint2D(markerNumbers=ends))
    for load in model.torques:
        turned = mbs.AddMarker(item.MarkerBodyRigid(bodyNumber=numbers[load.body]))
        mbs.AddLoad(item.LoadTorqueVector(markerNumber=turned, loadVector=list(load.torque)))
    for spring in model.springs:
        line = spring.measure
        ends = [end(line.i, line.P_i), end(line.j, line.P_j)]
        length = {"referenceLength": spring["rest"], "stiffness": spring["stiffness"]}
        mbs.AddObject(item.ObjectConnectorSpringDamper(markerNumbers=ends, **length))
    place = exu.OutputVariableType.Position
    sensors = [
        mbs.AddSensor(
            item.SensorBody(
                bodyNumber=number,
                localPosition=list(-centres[body]),
                storeInternal=True,
                outputVariableType=place,
            )
        )
        for body, number in numbers.items()
        if body
    ]
    mbs.Assemble()
    return mbs, sensors


def places_after(system, step, end, sparse, tolerance=1e-8):
    """Integrate a system of `planar_system` by generalised-alpha: places (bodies - 1, 3) at the end, m."""
    import exudyn as exu

    mbs, sensors = system
    settings = exu.SimulationSettings()
    stepping = settings.timeIntegration
    stepping.numberOfSteps, stepping.endTime, stepping.verboseMode = round(end / step), end, 0
    stepping.generalizedAlpha.spectralRadius = 0.9
    stepping.newton.useModifiedNewton, stepping.newton.relativeTolerance = True, tolerance
    if sparse:
        settings.linearSolverType = exu.LinearSolverType.EigenSparse
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = end
    mbs.SolveDynamic(settings)
    return np.array([mbs.GetSensorStoredData(sensor)[-1, 1:] for sensor in sensors])
