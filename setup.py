"""Puts decks and commit into a wheel, and compiled kernels where FLEXMB_REQUIRE_AOT=1 asks for them.

The objects are those of all processors and systems of `kernels/signatures.py`: one wheel serves them all.
numba emits them here for every target: no other compiler is needed, neither here nor at the installation.
"""

import os
import runpy
import shutil
import sys
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

TOP = Path(__file__).resolve().parent
WANTED = os.environ.get("FLEXMB_REQUIRE_AOT", "0") not in ("", "0")


def write_commit(library):
    """Keep the commit of the checkout for `flexmb --version`; an archive without git has none."""
    place = Path("flexmb_cli", "cli", "terminal")
    commit = runpy.run_path(str(TOP / place / "commit.py"))["commit"](TOP)
    (Path(library) / place / "_commit.txt").write_text(commit, encoding="utf-8")


class WithDecksAndObjects(build_py):
    """The package's files, the decks of `flexmb examples`, and the objects beside the kernels."""

    def run(self):
        """Copy the files, and compile."""
        super().run()
        if not self.editable_mode:
            shutil.copytree(TOP / "decks", Path(self.build_lib) / "flexmb_cli" / "decks", dirs_exist_ok=True)
            write_commit(self.build_lib)
        if WANTED and not self.editable_mode:
            sys.path.insert(0, str(TOP))
            from flexmb_cli.kernels._entry import package_objects

            for path in package_objects(Path(self.build_lib) / "flexmb_cli" / "kernels" / "objects"):
                print(f"compiled {path}", flush=True)


setup(
    cmdclass={"build_py": WithDecksAndObjects}, setup_requires=["numba>=0.61", "numpy>=2.0"] if WANTED else []
)
