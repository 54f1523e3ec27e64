#!/usr/bin/env python3
"""Print what an optimization found: perception entropy before and after, and where the files are.

usage: tools/show_result.py FOLDER
"""

import json
import sys
from pathlib import Path


def main() -> int:
    """Run the command line."""
    folder = Path(sys.argv[1]).resolve()
    result = json.loads((folder / "result.json").read_text("utf-8"))
    print(f"entropy before  {result['before']['entropy']:.4f}")
    print(f"entropy after   {result['entropy']:.4f}   (lower is better)")
    for name in ("review.png", "result.json", "optimized.blend"):
        if (folder / name).exists():
            print(folder / name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
