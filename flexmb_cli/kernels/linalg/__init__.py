"""Small dense and profile linear algebra in loops, the same bits on every processor."""
