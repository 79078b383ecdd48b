"""A tree in absolute coordinates, for `verify` and `--formulation absolute`."""
