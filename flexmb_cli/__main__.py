"""``python -m flexmb_cli`` is the same program as ``flexmb``."""

from .cli import main

main()
