"""Sweeps: parameters, cases, checkpoints, workers, table."""
