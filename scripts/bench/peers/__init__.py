"""The work of `table` in other programs: Exudyn, MuJoCo, and plain compiled code."""
