"""``python -m pe_core``: the same as ``pe``."""

import sys

from .app.cli import main

sys.exit(main())
