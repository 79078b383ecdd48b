"""Plots, the report page and scenes."""
