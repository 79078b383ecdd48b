"""The algorithm of the program YOUNG (1996) with its known errors, to explain archived listings."""
