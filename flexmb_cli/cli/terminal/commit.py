"""The commit of the checkout in which flexmb runs or was built, read from files; starts no program."""

from pathlib import Path

DIGITS_SHOWN = 10  # digits
CHECKOUT = Path(__file__).resolve().parents[3]
BUILT_FROM = Path(__file__).with_name("_commit.txt")  # that setup.py puts into an installation


def commit(checkout: Path = CHECKOUT, built_from: Path = BUILT_FROM) -> str:
    """Return the first digits of the commit, "" where neither checkout nor installation has it."""
    try:
        if (checkout / "pyproject.toml").is_file():
            digits = _head(_git_folder(checkout))
        else:
            digits = built_from.read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError):
        return ""
    is_hash = len(digits) >= DIGITS_SHOWN and all(digit in "0123456789abcdef" for digit in digits)
    return digits[:DIGITS_SHOWN] if is_hash else ""


def _git_folder(checkout: Path) -> Path:
    """The folder .git, or the one that a file .git of a further working tree names."""
    git = checkout / ".git"
    if git.is_dir():
        return git
    return checkout / git.read_text(encoding="utf-8").removeprefix("gitdir:").strip()


def _head(git: Path) -> str:
    head = (git / "HEAD").read_text(encoding="utf-8").strip()
    if not head.startswith("ref:"):
        return head
    name = head.removeprefix("ref:").strip()
    folders = [git]
    if (git / "commondir").is_file():
        folders.append(git / (git / "commondir").read_text(encoding="utf-8").strip())
    for folder in folders:
        if (folder / name).is_file():
            return (folder / name).read_text(encoding="utf-8").strip()
    return _packed(folders[-1], name)


def _packed(folder: Path, name: str) -> str:
    for line in (folder / "packed-refs").read_text(encoding="utf-8").splitlines():
        digits, _, ref = line.partition(" ")
        if ref == name:
            return digits
    return ""
