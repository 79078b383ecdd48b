"""Sphinx settings.  Chosen for checked references and pages made from click; MyST reads Markdown."""

import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "_ext"))
sys.path.insert(0, str(HERE.parent))

from flexmb_cli import __version__  # noqa: E402

project = "flexmb"
author = "flexmb developers"
release = version = __version__
extensions = ["myst_parser", "sphinx_design", "sphinx_click", "mathml", "breaks", "sphinx.ext.autodoc"]
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = f"flexmb {release}"
html_static_path = ["_static"]
(HERE / "_build" / "extra").mkdir(parents=True, exist_ok=True)
html_extra_path = ["_build/extra"]  # the live pages of the gallery
html_css_files = ["flexmb.css"]
html_show_copyright = False
exclude_patterns = ["_build", "_ext"]
nitpicky = False
smartquotes = False  # which would make one dash of the two of an option
# Links to pages of other sites are not followed: the documentation builds without a network.
linkcheck_ignore = [r"https?://.*"]
# The formats are described beside the decks, for readers of the repository; here they are included.
suppress_warnings = ["myst.xref_missing"]


def setup(app):
    """Draw the pictures and the gallery before the pages are read."""
    app.connect("builder-inited", _draw)


def _draw(app):
    subprocess.run([sys.executable, str(HERE / "_ext" / "pictures.py")], check=True)
