"""Assembly, kinematic analysis and inverse dynamics of mechanisms."""
