"""Installation of flexmb on this machine: from a checkout or from a wheel, by pip, pipx or uv."""

import importlib.util
import json
import os
import re
import shlex
import sys
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path
from urllib.parse import unquote, urlparse

DISTRIBUTION = "flexmb"


def install_command(extra: str) -> str:
    """Return the shell command that installs an extra into the environment that runs this program."""
    checkout = _checkout()
    if checkout is not None:
        where = "." if checkout == Path.cwd() else str(checkout)
        return f"{_installer()} -e {shlex.quote(f'{where}[{extra}]')}"
    # flexmb is on no index: its extra is installed by the names of its libraries.
    return command_for(_libraries(extra))


def command_for(libraries: Sequence[str]) -> str:
    """Return the shell command that installs libraries into the environment that runs this program."""
    named = " ".join(map(shlex.quote, libraries))
    if Path(sys.prefix, "pipx_metadata.json").exists():
        return f"pipx inject {DISTRIBUTION} {named}"
    return f"{_installer()} {named}"


def _checkout() -> Path | None:
    """Folder of the checkout that is installed in place; None for a wheel."""
    try:
        origin = json.loads(metadata.distribution(DISTRIBUTION).read_text("direct_url.json") or "{}")
    except (metadata.PackageNotFoundError, ValueError):
        origin = {}
    if origin.get("dir_info", {}).get("editable"):
        return Path(unquote(urlparse(origin["url"]).path))
    top = Path(__file__).resolve().parents[1]
    # Run as `python -m flexmb_cli` where it was not installed at all.
    return top if (top / "pyproject.toml").is_file() and not origin else None


def _installer() -> str:
    """The pip of this environment, as one would call it from the current folder."""
    folder = Path(sys.executable).parent
    if (folder / "pip").exists():
        return f"{shlex.quote(_short(folder / 'pip'))} install"
    python = shlex.quote(_short(Path(sys.executable)))
    if importlib.util.find_spec("pip") is None:
        return f"uv pip install --python {python}"
    return f"{python} -m pip install"


def _short(path: Path) -> str:
    short = os.path.relpath(path)
    return str(path) if short.startswith(os.pardir) else short


def _libraries(extra: str) -> list[str]:
    """Requirements of an extra, with those of the extras that it names: `flexmb[plot]` of `movie`."""
    try:
        required = metadata.requires(DISTRIBUTION) or []
    except metadata.PackageNotFoundError:
        required = []
    return _required_by(extra, required) or [extra]


def _required_by(extra: str, required: Sequence[str]) -> list[str]:
    marked = re.compile(rf"(.*?)\s*;.*\bextra == ['\"]{re.escape(extra)}['\"].*")
    own = [match[1] for line in required if (match := marked.fullmatch(line))]
    names: list[str] = []
    for library in own:
        nested = re.fullmatch(rf"{DISTRIBUTION}\[(.*)\]", library)
        extras = nested[1].split(",") if nested else []
        names += [name for one in extras for name in _required_by(one.strip(), required)] or [library]
    return names
