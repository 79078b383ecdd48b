"""Files of finite-element programs: node tables, mass and stiffness matrices, one file a format."""
