"""``python -m studies.published``: compare the scores with published results of detectors."""

from ..command import main, page_parser
from .validate import validate

FOLDER, QUICK_FOLDER = "docs/validity", "validity-quick"

if __name__ == "__main__":
    parser, _ = page_parser(
        "published",
        "compare the scores with published results of detectors",
        (FOLDER, QUICK_FOLDER),
        "on few voxels and objects, in a minute",
    )
    main(parser, validate)
