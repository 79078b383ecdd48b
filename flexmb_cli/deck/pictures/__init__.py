"""Text of many rows at once."""
