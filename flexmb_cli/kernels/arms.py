"""Arms of bodies, c + S η in body axes, as vectors in global axes with rate and remainder of acceleration.

Vlasenko and Kasper (2008), kinematics of a node: with s = c + S η and A the body's rotation,

    arm = A s,   rate = A (ω~ s + S η̇),   rest = A (ω~ ω~ s + 2 ω~ S η̇),

`rest` the second derivative without those of the coordinates; the arms of the ground (body -1) rest.
Spans are the vectors V and W of the measures: an arm, or the point at the end of one less that of another.
"""

from ._jit import kernel
from .constrained_system import A
from .rotation import rotate

ARM, RATE, REST = 0, 1, 2


@kernel
def _deformed(system, arm, x, first):
    """S x (3,) of one arm for the modal coordinates or rates that begin at x[first]."""
    N, at = arm["modes"], arm["shape"]
    s0 = s1 = s2 = 0.0
    for k in range(N):
        eta = x[first + arm["first"] + k]
        s0 += system.shapes[at + k] * eta
        s1 += system.shapes[at + N + k] * eta
        s2 += system.shapes[at + 2 * N + k] * eta
    return s0, s1, s2


@kernel
def place_arms(system, work, q):
    """Fill arms and spans at q, where the rotation matrices belong to q."""
    first = 7 * system.masses.shape[0]
    for p in range(system.arms.shape[0]):
        arm = system.arms[p]
        c, d = arm["c"], _deformed(system, arm, q, first)
        s = (c[0] + d[0], c[1] + d[1], c[2] + d[2])
        v = rotate(work.rotations[A], arm["body"], s) if arm["body"] >= 0 else s
        for i in range(3):
            work.arms[ARM, p, i] = v[i]
    _fill_spans(system, work, ARM, q, 7)


@kernel
def move_arms(system, work, u):
    """Fill rates and remainders at the speeds u, where the arms have been placed."""
    first = 6 * system.masses.shape[0]
    for p in range(system.arms.shape[0]):
        arm, b = system.arms[p], system.arms[p]["body"]
        if b < 0:
            continue
        s, k = work.arms[ARM, p], 6 * b + 3
        w = rotate(work.rotations[A], b, (u[k], u[k + 1], u[k + 2]))
        d = rotate(work.rotations[A], b, _deformed(system, arm, u, first))
        turned = cross(w, s)
        rest = cross(w, (turned[0] + 2.0 * d[0], turned[1] + 2.0 * d[1], turned[2] + 2.0 * d[2]))
        for i in range(3):
            work.arms[RATE, p, i] = turned[i] + d[i]
            work.arms[REST, p, i] = rest[i]
    _fill_spans(system, work, RATE, u, 6)
    _fill_spans(system, work, REST, u, 0)


@kernel
def cross(a, b):
    """a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def _fill_spans(system, work, layer, origins, stride):
    """Fill one layer of the spans; origins: q or u, of which a body has `stride` numbers, 0: none."""
    for k in range(system.measures.shape[0]):
        for side in range(2):
            head, tail = system.measures[k]["ends"][side, 0], system.measures[k]["ends"][side, 1]
            if head < 0:
                continue
            i, j = system.arms[head]["body"], system.arms[head]["body"]
            if tail >= 0:
                j = system.arms[tail]["body"]
            for axis in range(3):
                d = work.arms[layer, head, axis]
                if tail >= 0:
                    d -= work.arms[layer, tail, axis]
                # The origin of one body would only cost digits.
                if i != j and stride > 0 and i >= 0:
                    d += origins[stride * i + axis]
                if i != j and stride > 0 and j >= 0:
                    d -= origins[stride * j + axis]
                work.spans[layer, k, side, axis] = d


@kernel
def add_arm_row(system, work, p, w, factor, of_point, row):
    """Add to row (n,) the derivative of factor w · x by the speeds; x: the arm p, or the point at its end."""
    arm, b = system.arms[p], system.arms[p]["body"]
    if b < 0:
        return
    g = (factor * w[0], factor * w[1], factor * w[2])
    if of_point:
        for i in range(3):
            row[6 * b + i] += g[i]
    moment, axes = cross(work.arms[ARM, p], g), work.rotations[A, b]
    N, at, first = arm["modes"], arm["shape"], 6 * system.masses.shape[0] + arm["first"]
    for i in range(3):
        row[6 * b + 3 + i] += axes[0, i] * moment[0] + axes[1, i] * moment[1] + axes[2, i] * moment[2]
        turned = axes[0, i] * g[0] + axes[1, i] * g[1] + axes[2, i] * g[2]
        for mode in range(N):
            row[first + mode] += system.shapes[at + i * N + mode] * turned
