"""``python -m pe_core`` and the script ``pe``: Ctrl-C is answered from the start.

Nothing is imported on top that takes long.
"""

import os
import signal
import sys
from types import FrameType


def main() -> None:
    """Run the command and exit with its status."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _leave)
    from .app.cli import main as run

    if signal.getsignal(signal.SIGINT) is _leave:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    leave(run())


def leave(status: int) -> None:
    """Exit; at once when a signal has ended the work, whose threads may be busy for a while."""
    if status <= 128:
        sys.exit(status)
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (AttributeError, OSError, ValueError):  # it is closed, or nobody reads it
            pass
    os._exit(status)


def _leave(_signum: int, _frame: FrameType | None) -> None:
    """While loading there is nothing to lose."""
    os.write(2, b"pe: interrupted\n")
    os._exit(130)


if __name__ == "__main__":
    main()
