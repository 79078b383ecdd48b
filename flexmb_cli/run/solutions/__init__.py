"""Solutions of every type of model."""
