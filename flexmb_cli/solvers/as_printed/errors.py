"""The known errors of the program YOUNG (1996), each with the sentence that `diff --explain` prints.

Each cause was found by putting the error into a re-computation of the dissertation's listings (Liang Yong,
1996, Appendix B).  Indices and overrun stand in the printed source (Appendix A).  The pages of the screw
joint are incomplete: its terms are fitted to OUT2-6-1.
"""

TRANSPOSED = "QD[body, coordinate] is read as QD[coordinate, body]"
OVERRUN = "the fourth element of a three-element array is used in the universal joint's s_i · s_j row"
WRONG_INDEX = "components M for N in the cylindrical and translational right-hand sides"
SCREW = "the angle in the second quadrant, a factor 2 in the Jacobian, and eq. (4.50) where sin θ = 0"

ALL_ERRORS = frozenset({TRANSPOSED, OVERRUN, WRONG_INDEX, SCREW})
AS_PRINTED = "as-printed"  # the option of a run that asks for them
EMULATED = "numbers of the program YOUNG of 1996 with its known errors (--as-printed), not of the mechanism"
