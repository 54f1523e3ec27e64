"""``python -m pe_tools`` and the script ``pe``: Ctrl-C is answered from the start. Nothing is
imported on top that takes long."""

import gc
import os
import signal
import sys
from types import FrameType

from .versions import versions_text

OBJECTS_TO_COLLECT = 100_000
"""New objects after which Python looks for cycles among them. By default it does so after 700, and
through all that is imported ten times, which stays."""


def main() -> None:
    """Run the command and exit with its status."""
    if sys.argv[1:] == ["--version"] and _printed(versions_text()):
        return
    gc.set_threshold(OBJECTS_TO_COLLECT)
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _leave)
    from .cli import leave
    from .cli.verbs import main as run

    if signal.getsignal(signal.SIGINT) is _leave:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    status = run()
    gc.freeze()  # else Python looks once more through all that there is, as it ends
    leave(status)


def _printed(text: str) -> bool:
    """Print a line; return whether that worked. If not, the command says why."""
    try:
        print(text, flush=True)
    except OSError:
        return False
    return True


def _leave(_signum: int, _frame: FrameType | None) -> None:
    """While loading there is nothing to lose."""
    try:
        os.write(2, b"pe: interrupted\n")
    finally:
        os._exit(130)


if __name__ == "__main__":
    main()
