"""Steps near jumps, at the limit of stability, and over whole turns."""
