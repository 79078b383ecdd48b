"""Datasets of the motion of bodies and points, by the names that analyses give these quantities."""

from .result_file import Series

BODY_VECTOR = ("body/body", "xyz")
JOINT_VECTOR = ("joint/joint", "xyz")
BODY_PARAMETERS = ("body/body", "euler_parameter")
POINT_VECTOR = ("point/point", "xyz")

BODY_MOTION = {
    "position": Series("body/position", BODY_VECTOR, "m", "origin of the body frame, global axes"),
    "euler_parameters": Series(
        "body/euler_parameters", BODY_PARAMETERS, "1", "Euler parameters, body to global"
    ),
    "velocity": Series("body/velocity", BODY_VECTOR, "m/s", "velocity of the origin, global axes"),
    "euler_parameter_rates": Series(
        "body/euler_parameter_rates", BODY_PARAMETERS, "1/s", "rates of Euler parameters"
    ),
    "acceleration": Series(
        "body/acceleration", BODY_VECTOR, "m/s2", "acceleration of the origin, global axes"
    ),
    "euler_parameter_accelerations": Series(
        "body/euler_parameter_accelerations",
        BODY_PARAMETERS,
        "1/s2",
        "second derivatives of Euler parameters",
    ),
    "angular_velocity": Series(
        "body/angular_velocity", BODY_VECTOR, "rad/s", "angular velocity, global axes"
    ),
    "angular_acceleration": Series(
        "body/angular_acceleration", BODY_VECTOR, "rad/s2", "angular acceleration, global axes"
    ),
}
POINT_MOTION = {
    "point_position": Series("point/position", POINT_VECTOR, "m", "position of the point, global axes"),
    "point_velocity": Series("point/velocity", POINT_VECTOR, "m/s", "velocity of the point, global axes"),
    "point_acceleration": Series(
        "point/acceleration", POINT_VECTOR, "m/s2", "acceleration of the point, global axes"
    ),
}
