"""Option types and groups that several commands share."""
