"""One file per constraint type: residual, Jacobian rows, acceleration right-hand side."""
