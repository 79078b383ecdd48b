"""One deck from its text to its result files: the stations in order, nothing printed."""
