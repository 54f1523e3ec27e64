"""``python -m studies.detectors``: train detectors at the placements of the plan."""

from pe_tools.cli import count_up_to

from ..command import main, page_parser
from .command import validate_own

FOLDER, QUICK_FOLDER = "docs/validity/own", "validity-own-quick"
MAX_RUNS = 10_000

if __name__ == "__main__":
    parser, _ = page_parser(
        "detectors",
        "train detectors at the placements of the plan",
        (FOLDER, QUICK_FOLDER),
        "a few runs of few scenes, in minutes",
    )
    which = parser.add_mutually_exclusive_group()
    about = "the study of camera placements instead of that of LiDARs"
    which.add_argument("--cameras", action="store_true", help=about)
    about = "the study before and after a search: its searches, unless they are done, and its runs"
    which.add_argument("--after-search", action="store_true", help=about)
    parser.add_argument("--resume", action="store_true", help="go on where the folder's runs end")
    about = "do at most so many runs now"
    parser.add_argument("--runs", type=count_up_to(MAX_RUNS), metavar="N", help=about)
    about = 'write the curves of [ap] model = "scans", fitted to the runs, to this file'
    parser.add_argument("--curves", metavar="FILE", help=about)
    main(parser, validate_own)
