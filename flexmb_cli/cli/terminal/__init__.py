"""Output of commands, and their endings."""
