"""Arms of bodies, c + S η in body axes, as vectors in global axes with rate and remainder of acceleration.

Vlasenko and Kasper (2008), kinematics of a node: with s = c + S η and A the body's rotation,

    arm = A s,   rate = A (ω~ s + S η̇),   rest = A (ω~ ω~ s + 2 ω~ S η̇),

`rest` the second derivative without those of the coordinates; the arms of the ground (body -1) rest.
Spans are the vectors V and W of the measures: an arm, or the point at the end of one less that of another.
"""

from collections import namedtuple

from .._jit import kernel
from ..linalg.rotation import rotate
from .system import A

ARM, RATE, REST = 0, 1, 2

Geometry = namedtuple("Geometry", "arms shapes measures axes placed spans")
Geometry.__doc__ = """What arms and measures need of a System and its Work, whose names these are.

A kernel called for every arm pays for every array that it is handed.  axes (b, 3, 3): A; placed: Work.arms.
"""


@kernel
def geometry_of(system, work):
    """The geometry of a mechanism: views, which follow the work."""
    return Geometry(system.arms, system.shapes, system.measures, work.rotations[A], work.arms, work.spans)


@kernel
def _deformed(arm, shapes, x, first):
    """S x (3,) of one arm for the modal coordinates or rates that begin at x[first]."""
    N, at = arm["modes"], arm["shape"]
    s0 = s1 = s2 = 0.0
    for k in range(N):
        eta = x[first + arm["first"] + k]
        s0 += shapes[at + k] * eta
        s1 += shapes[at + N + k] * eta
        s2 += shapes[at + 2 * N + k] * eta
    return s0, s1, s2


@kernel
def place_arms(geometry, q):
    """Fill arms and spans at q, where the rotation matrices belong to q."""
    first = 7 * geometry.axes.shape[0]
    for p in range(geometry.arms.shape[0]):
        arm = geometry.arms[p]
        c, d = arm["c"], _deformed(arm, geometry.shapes, q, first)
        s = (c[0] + d[0], c[1] + d[1], c[2] + d[2])
        v = rotate(geometry.axes, arm["body"], s) if arm["body"] >= 0 else s
        for i in range(3):
            geometry.placed[ARM, p, i] = v[i]
    _fill_spans(geometry, ARM, q, 7)


@kernel
def move_arms(geometry, u):
    """Fill rates and remainders at the speeds u, where the arms have been placed."""
    first = 6 * geometry.axes.shape[0]
    for p in range(geometry.arms.shape[0]):
        arm, b = geometry.arms[p], geometry.arms[p]["body"]
        if b < 0:
            continue
        k = 6 * b + 3
        s = vector(geometry.placed[ARM], p)
        w = rotate(geometry.axes, b, (u[k], u[k + 1], u[k + 2]))
        d = rotate(geometry.axes, b, _deformed(arm, geometry.shapes, u, first))
        turned = cross(w, s)
        rest = cross(w, (turned[0] + 2.0 * d[0], turned[1] + 2.0 * d[1], turned[2] + 2.0 * d[2]))
        for i in range(3):
            geometry.placed[RATE, p, i] = turned[i] + d[i]
            geometry.placed[REST, p, i] = rest[i]
    _fill_spans(geometry, RATE, u, 6)
    _fill_spans(geometry, REST, u, 0)


@kernel
def vector(rows, k):
    """Row k of rows (k, 3) as a triple."""
    return rows[k, 0], rows[k, 1], rows[k, 2]


@kernel
def cross(a, b):
    """a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def _fill_spans(geometry, layer, origins, stride):
    """Fill one layer of the spans; origins: q or u, of which a body has `stride` numbers, 0: none."""
    arms, placed = geometry.arms, geometry.placed
    for k in range(geometry.measures.shape[0]):
        ends = geometry.measures[k]["ends"]
        for side in range(2):
            head, tail = ends[side, 0], ends[side, 1]
            if head < 0:
                continue
            i = arms[head]["body"]
            j = arms[tail]["body"] if tail >= 0 else i
            for axis in range(3):
                d = placed[layer, head, axis]
                if tail >= 0:
                    d -= placed[layer, tail, axis]
                # The origin of one body would only cost digits.
                if i != j and stride > 0 and i >= 0:
                    d += origins[stride * i + axis]
                if i != j and stride > 0 and j >= 0:
                    d -= origins[stride * j + axis]
                geometry.spans[layer, k, side, axis] = d


@kernel
def add_arm_row(geometry, p, w, factor, of_point, row):
    """Add to row (n,) the derivative of factor w · x by the speeds; x: the arm p, or the point at its end."""
    arm, b = geometry.arms[p], geometry.arms[p]["body"]
    if b < 0:
        return
    g = (factor * w[0], factor * w[1], factor * w[2])
    if of_point:
        for i in range(3):
            row[6 * b + i] += g[i]
    moment, axes = cross(vector(geometry.placed[ARM], p), g), geometry.axes[b]
    N, at, first = arm["modes"], arm["shape"], 6 * geometry.axes.shape[0] + arm["first"]
    for i in range(3):
        row[6 * b + 3 + i] += axes[0, i] * moment[0] + axes[1, i] * moment[1] + axes[2, i] * moment[2]
        turned = axes[0, i] * g[0] + axes[1, i] * g[1] + axes[2, i] * g[2]
        for mode in range(N):
            row[first + mode] += geometry.shapes[at + i * N + mode] * turned
