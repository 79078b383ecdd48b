"""From the files of a finite-element program to flexible bodies; between model and solvers."""
