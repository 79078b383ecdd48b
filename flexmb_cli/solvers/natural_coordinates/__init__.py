"""A second formulation of YOUNG mechanisms, for `verify`."""
