"""From the files of a finite-element program to flexible bodies; the station between model and solve."""
