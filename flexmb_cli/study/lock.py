"""One sweep at a time in the folder of a study.

The lock is the system's, on a file in the folder: it is free again however its process ends.
"""

import os
from contextlib import suppress

from ..errors import OutputError
from ..managed_files import ManagedFolder
from ..results.files.disk_failures import located
from ..results.files.replaced_file import make_folder
from ..results.files.temporary_file import hold

LOCK = "lock"


class StudyLock:
    """The right to write in `folder`, which is made if it is missing; `study` is named to who comes second.

    Raises OutputError while another process has it, or when the folder cannot be made.
    """

    def __init__(self, folder: str, study: str):
        self.folder, self.path = folder, os.path.join(folder, LOCK)
        while not self._taken(study):
            # A sweep that has just ended took folder and lock away.
            continue

    def leave(self) -> None:
        """Give the folder up, and remove it when nothing else is in it."""
        with suppress(OSError):
            # While it is held: who opens it from now on sees that it is gone, and makes another.
            os.unlink(self.path)
        self._file.close()
        with suppress(OSError):
            os.rmdir(self.folder)

    def _taken(self, study: str) -> bool:
        make_folder(self.folder)
        with located(self.path), ManagedFolder(self.folder) as folder:
            self._file = open(folder.open(LOCK, os.O_WRONLY | os.O_CREAT), "ab")  # noqa: SIM115
        if hold(self._file) is False:
            self._file.close()
            raise OutputError(
                f"{study}: another sweep is writing this study, its cases are in {self.folder}; wait until "
                "it ends or stop it, or have it solved elsewhere (-o and --parts name other places)",
                id="STUDY-010",
            )
        stands = self._stands()
        if not stands:
            self._file.close()
        return stands

    def _stands(self) -> bool:
        try:
            return os.path.samestat(os.fstat(self._file.fileno()), os.lstat(self.path))
        except FileNotFoundError:
            return False
