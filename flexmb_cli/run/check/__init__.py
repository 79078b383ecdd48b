"""Diagnosis of a deck without solving it."""
