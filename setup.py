"""Puts decks and commit into a wheel, kernels if FLEXMB_REQUIRE_AOT=1, and pages if FLEXMB_REQUIRE_DOCS=1.

The libraries are those of all processors and systems of `kernels/signatures.py`: one wheel serves them all.
numba emits the objects here for every target; Zig, which brings what each system's linker needs, links them.
"""

import os
import runpy
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

TOP = Path(__file__).resolve().parent
WANTED = os.environ.get("FLEXMB_REQUIRE_AOT", "0") not in ("", "0")
PAGES = os.environ.get("FLEXMB_REQUIRE_DOCS", "0") not in ("", "0")
# Zig's name of processor and system, with the oldest version of it.
ZIG = {
    "x86_64-linux": "x86_64-linux-gnu.2.17",
    "arm64-linux": "aarch64-linux-gnu.2.17",
    "x86_64-macos": "x86_64-macos.13.0",
    "arm64-macos": "aarch64-macos.13.0",
    "x86_64-windows": "x86_64-windows-gnu",
    "arm64-windows": "aarch64-windows-gnu",
}


def write_commit(library):
    """Keep the commit of the checkout for `flexmb --version`; an archive without git has none."""
    place = Path("flexmb_cli", "cli", "terminal")
    commit = runpy.run_path(str(TOP / place / "commit.py"))["commit"](TOP)
    (Path(library) / place / "_commit.txt").write_text(commit, encoding="utf-8")


def write_pages(library):
    """Copy the pages that `scripts/docs` has built, without the sources that a browser does not show."""
    built, place = TOP / "docs" / "_build" / "html", Path(library) / "flexmb_cli" / "docs"
    # Those of an earlier build would stay.
    shutil.rmtree(place, ignore_errors=True)
    if PAGES:
        if not (built / "index.html").is_file():
            raise SystemExit("there are no built pages: run scripts/docs first")
        shutil.copytree(built, place, ignore=shutil.ignore_patterns("_sources", ".doctrees", "objects.inv"))


def link(command, objects, library):
    """Link objects, the machine code of units by name, into a shared library."""
    with tempfile.TemporaryDirectory() as folder:
        files = []
        for unit, code in objects.items():
            files.append(Path(folder, f"{unit}.o"))
            files[-1].write_bytes(code)
        if library.suffix == ".dll":
            # The mark of code that computes with floats, which Microsoft's own C library defines.
            files.append(Path(folder, "mark.c"))
            files[-1].write_text("int _fltused;\n")
        linked = Path(folder, library.name)
        subprocess.run([*command, "-shared", "-s", "-o", linked, *files, "-lm"], check=True)
        library.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(linked, library)


def write_libraries(folder):
    """Compile all kernels for all targets into `folder`."""
    from flexmb_cli.kernels._entry import Unit
    from flexmb_cli.kernels._library import library_name
    from flexmb_cli.kernels.signatures import UNITS

    made = {unit: Unit(unit).emit(list(ZIG)) for unit in UNITS}
    for target, name in ZIG.items():
        library = Path(folder) / library_name(target)
        zig = [sys.executable, "-m", "ziglang", "cc", "-target", name]
        link(zig, {unit: objects[target] for unit, objects in made.items()}, library)
        print(f"linked {library}", flush=True)


class WithDecksAndLibraries(build_py):
    """The package's files, the decks of `flexmb examples`, and the libraries beside the kernels."""

    def run(self):
        """Copy the files, and compile."""
        super().run()
        if not self.editable_mode:
            shutil.copytree(TOP / "decks", Path(self.build_lib) / "flexmb_cli" / "decks", dirs_exist_ok=True)
            write_commit(self.build_lib)
            write_pages(self.build_lib)
            libraries = Path(self.build_lib) / "flexmb_cli" / "kernels" / "libraries"
            # Those of an earlier build would be loaded, whatever the kernels are now.
            shutil.rmtree(libraries, ignore_errors=True)
            if WANTED:
                sys.path.insert(0, str(TOP))
                write_libraries(libraries)


if __name__ == "__main__":
    setup(
        cmdclass={"build_py": WithDecksAndLibraries},
        setup_requires=["numba>=0.61", "numpy>=2.0", "ziglang>=0.16"] if WANTED else [],
    )
