"""The commit of the checkout in which flexmb runs or was built."""

import subprocess
from pathlib import Path

DIGITS_SHOWN = 10  # digits
CHECKOUT = Path(__file__).resolve().parents[3]
BUILT_FROM = Path(__file__).with_name("_commit.txt")  # that setup.py puts into an installation


def commit(checkout: Path = CHECKOUT, built_from: Path = BUILT_FROM) -> str:
    """Return the first digits of the commit, "" where neither checkout nor installation has it."""
    try:
        if (checkout / "pyproject.toml").is_file():
            # The folder is named, so that git does not take a repository in which an archive was unpacked.
            command = ["git", "--git-dir", str(checkout / ".git"), "rev-parse", "HEAD"]
            found = subprocess.run(command, capture_output=True, text=True).stdout.strip()
        else:
            found = built_from.read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError):
        return ""
    is_hash = len(found) >= DIGITS_SHOWN and all(digit in "0123456789abcdef" for digit in found)
    return found[:DIGITS_SHOWN] if is_hash else ""
