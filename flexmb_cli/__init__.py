"""flexmb: kinematics and dynamics of rigid and flexible multibody systems from legacy decks."""

__version__ = "0.1.0"
