"""Integrators: DOP853, SDIRK4, Radau IIA of order 5, generalised-α.

Arrays that kernels here share, for n speeds and states of N numbers; those of the integrations are described
in their classes, `tree`, `work` and `coordinates` in `kernels.tree`.

- z (N,), old (N,), new (N,): states; state (N,): one whose size the tolerances are relative to
- slope (N,): rates of a state; slopes (16, N): those of the stages of a step; weights (16,): of these
- dense (7, N): terms of the dense output of a step
- change (N,): difference of two states
- q (n + b,), u (n,), ud (n,): coordinates, speeds and accelerations of b bodies
- clock (), memory (): records of CLOCK and of the method's MEMORY
- tree (): a TreeArrays; work (F,): FRAME_WORK; coordinates (NS,): COORDINATE_WORK; closures (R,): CLOSURE_ROW
- angles (angles,): angles expected, rad
- out (N,), point (N,): the state that a kernel fills
"""
