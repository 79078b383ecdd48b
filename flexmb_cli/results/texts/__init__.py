"""Texts that commands print of models and results."""
