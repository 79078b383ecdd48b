"""Forward dynamics in absolute coordinates."""
