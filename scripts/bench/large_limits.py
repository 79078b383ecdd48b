"""What a deck may hold at most (docs/reference/limits.md), less what the decks have already."""

YOUNG_LOADS = 199_990  # dynamic cards besides MASS and VELOCITY
DAFMS_BODIES = 5000
DAFMS_NUMBERS = 345_000  # outside long lists
DAFMS_NUMBERS_OF_BODY = 60  # in a chain of rigid bodies
VSDF_CARDS = 99_990  # of a type other than NODE and TABL
ELEMENTS = 19_990  # and functions
DAFMS_ELEMENTS = 14_000  # elements of 24 numbers
NUMBERS_OF_CARD = 199_990  # of a YOUNG card
