"""``python -m flexmb_cli`` is the same program as ``flexmb``."""

import atexit
import gc
import sys

INTERRUPTED = 130
# Readers make objects by the hundred thousand and hardly a cycle: at Python's 700 the search for cycles takes
# a third of the time of a large file, and a tenth of that of imports.
OBJECTS_UNTIL_COLLECTED = 50_000


def main() -> None:
    """Entry point of `flexmb`; Ctrl-C is heeded without a traceback while the commands are imported, too."""
    gc.set_threshold(OBJECTS_UNTIL_COLLECTED)
    # The system takes all memory back at once; to look for cycles in it is a tenth of a short run.
    atexit.register(gc.freeze)
    try:
        from .cli import main as run
    except KeyboardInterrupt:
        print("flexmb: interrupted; nothing was begun", file=sys.stderr)
        sys.exit(INTERRUPTED)
    run()


if __name__ == "__main__":
    main()
