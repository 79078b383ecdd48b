"""Solid elements of a body: shape functions, stiffness and mass, stresses, stiffening by stresses."""
