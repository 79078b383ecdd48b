"""Decks with motions of closed form, whose numbers are variables."""

from pathlib import Path

DECKS = Path(__file__).resolve().parents[2] / "decks"

SLIDER_CRANK = """SET crank = 1
SET rod = 3
SET start = 0.5
SET speed = 2
4 1 1 1 0 1 1 1 0 0 0 1
0 0 0 1 0 0 0
0 0 0 0.9689 0 0 0.2474
0.8776 0.4794 0 0.9968 0 0 -0.0802
3.8391 0 0 1 0 0 0
2 6 $start $speed 0
3 $rod 0 0
2 3 $crank 0 0  0 0 0
1 2 0 0 0  0 0 0  0 0 1  0 0 1
3 4 $rod 0 0  0 0 0  $rod 0 1  0 0 1
1 4 0 0 0  0 0 0  1 0 0  1 0 0  0 1 0  0 0 1
1 0 0 0 0 0 0
0 2 0.1
"""

OSCILLATOR = """SET mass = 2
SET stiffness = 50
SET damping = 1.5
SET speed = 0.8
2 0 0 0 0 0 0 1 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 2 0 0 0  0 0 0  1 0 0  1 0 0  0 1 0  0 0 1
1 0 0 0 0 0 0
0 1 0.05

DYNAMICS forward
MASS 2 $mass 0 0 0 1 1 1
ELEMENTS
  SPRING s at=1.stroke stiffness=$stiffness damping=$damping
  START at=1.stroke rate=$speed
END
"""

# A sphere meets a plane once, without weight: Hunt and Crossley's force of exponent n.
COLLISION = """SET speed = 2
SET stiffness = 2e6
SET loss = 0.4
2 0 0 0 0 0 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0.55 1 0 0 0
1 0 0 0 0 0 0
0 1 0.02

DYNAMICS forward
MASS 2 0.5 0 0 0 5e-4 5e-4 5e-4
VELOCITY 2 0 0 $(-speed) 0 0 0
ELEMENTS
  CONTACT touch plane-sphere from=0(0,0,0) to=2(0,0,0) normal=(0,0,1) radius_to=0.05
    stiffness=$stiffness exponent=1.5 damping=$loss
END
"""
