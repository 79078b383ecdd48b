"""Newton's and Euler's equations of every body, from the reported motion and forces alone.

Rotation matrices, points of action and moments are formed here, in global axes about the centres of
mass: nothing of the program's own mass matrix or Jacobian is used.
"""

import numpy as np

from flexmb_cli.model.loads import holders


def rotation(p):
    e0, e1, e2, e3 = p
    e = np.array([e1, e2, e3])
    tilde = np.array([[0, -e3, e2], [e3, 0, -e1], [-e2, e1, 0]])
    return (2 * e0 * e0 - 1) * np.eye(3) + 2 * np.outer(e, e) + 2 * e0 * tilde


def tensor(inertia):
    xx, yy, zz, xy, yz, zx = inertia
    return np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])


class BodyBalances:
    """The sums of forces and of moments about the centres of mass at one report row."""

    def __init__(self, model, rows, row):
        self.model, self.rows, self.row = model, rows, row
        self.r = rows.position[row]
        self.A = [rotation(p) for p in rows.euler_parameters[row]]
        self.centres = np.zeros_like(self.r)
        for item in model.masses:
            self.centres[item.body] = self.A[item.body] @ item.centre
        self.force, self.moment = np.zeros_like(self.r), np.zeros_like(self.r)

    def place(self, body, point):
        return self.r[body] + self.A[body] @ point

    def velocity(self, body, point):
        arm = self.A[body] @ point
        return self.rows.velocity[self.row, body] + np.cross(self.rows.angular_velocity[self.row, body], arm)

    def add(self, body, force, place, torque=(0.0, 0.0, 0.0)):
        centre = self.r[body] + self.centres[body]
        self.force[body] += force
        self.moment[body] += torque + np.cross(place - centre, force)

    def add_constraints(self):
        mechanism, rows, k = self.model.mechanism, self.rows, self.row
        for n, joint in enumerate(mechanism.joints):
            place = self.place(joint.j, joint.P_j)
            self.add(joint.j, rows.reaction_force[k, n], place, rows.reaction_torque[k, n])
            self.add(joint.i, -rows.reaction_force[k, n], place, -rows.reaction_torque[k, n])
        for n, (_, body) in enumerate(holders(mechanism)):
            self.add(body, rows.holding_force[k, n], self.r[body], rows.holding_torque[k, n])
        for n, driver in enumerate(mechanism.drivers):
            effort = np.zeros(6)
            effort[driver.direction - 1] = rows.driver_effort[k, n]
            self.add(driver.body, effort[:3], self.r[driver.body], effort[3:])

    def add_loads(self):
        for item in self.model.masses:
            weight = item.mass * np.array(self.model.gravity)
            self.add(item.body, weight, self.r[item.body] + self.centres[item.body])
        for item in self.model.forces:
            force = self.A[item.body] @ item.force if item.following else np.array(item.force)
            self.add(item.body, force, self.place(item.body, item.point))
        for item in self.model.torques:
            torque = self.A[item.body] @ item.torque if item.following else np.array(item.torque)
            self.add(item.body, np.zeros(3), self.r[item.body], torque)
        for item in self.model.springs:
            self._add_spring(item)

    def _add_spring(self, item):
        (i, j, P_i, P_j), (stiffness, rest, damping, *_) = item.measure, item.values
        a, b = self.place(i, P_i), self.place(j, P_j)
        length = np.linalg.norm(b - a)
        along = (b - a) / length
        rate = along @ (self.velocity(j, P_j) - self.velocity(i, P_i))
        pull = stiffness * (length - rest) + damping * rate
        self.add(i, pull * along, a)
        self.add(j, -pull * along, b)

    def missing(self):
        """What is left of force = mass × acceleration and moment = rate of spin, (bodies, 6)."""
        self.add_constraints()
        self.add_loads()
        left = np.concatenate([self.force, self.moment], axis=1)
        for item in self.model.masses:
            b, k = item.body, self.row
            w, wd = self.rows.angular_velocity[k, b], self.rows.angular_acceleration[k, b]
            c = self.centres[b]
            J = self.A[b] @ tensor(item.inertia) @ self.A[b].T
            acceleration = self.rows.acceleration[k, b] + np.cross(wd, c) + np.cross(w, np.cross(w, c))
            left[b, :3] -= item.mass * acceleration
            left[b, 3:] -= J @ wd + np.cross(w, J @ w)
        return left


def worst_balance(model, rows):
    """Largest imbalance of all bodies and rows over the largest reaction, both in N and N m."""
    largest = max(np.abs(rows.reaction_force).max(initial=1.0), np.abs(rows.holding_force).max(initial=1.0))
    worst = max(np.abs(BodyBalances(model, rows, k).missing()).max() for k in range(len(rows.time)))
    return worst / largest
