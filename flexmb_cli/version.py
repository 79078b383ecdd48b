"""Version of the program, which results and studies name."""

__version__ = "0.1.0"
