"""``python -m flexmb_cli`` is the same program as ``flexmb``."""

import sys

INTERRUPTED = 130


def main():
    """Entry point of `flexmb`; Ctrl-C is heeded without a traceback while the commands are imported, too."""
    try:
        from .cli import main as run
    except KeyboardInterrupt:
        print("flexmb: interrupted; nothing was begun", file=sys.stderr)
        sys.exit(INTERRUPTED)
    run()


if __name__ == "__main__":
    main()
