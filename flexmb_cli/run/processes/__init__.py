"""Worker processes, signals and the parent's watch."""
