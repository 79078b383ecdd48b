"""h5py, imported without a call of the program `uname`.

To learn the type of machine it asks for all that `platform.uname()` has, and for the last item Python starts
`uname -p`: this process, and the modules that start it, took a twentieth of the time of a short run.
"""

import platform

_known = vars(platform.uname())
_asked = "processor" in _known
_known.setdefault("processor", "")
try:
    import h5py
finally:
    if not _asked:
        del _known["processor"]  # another module may need the true one

__all__ = ["h5py"]
