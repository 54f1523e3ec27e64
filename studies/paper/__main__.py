"""``python -m studies.paper``: run the paper's experiments and report on them."""

from ..command import main, page_parser
from .reproduce import reproduce

FOLDER, QUICK_FOLDER = "docs/reproduction", "reproduction-quick"

if __name__ == "__main__":
    about = "run the paper's experiments and report on them"
    parser, alternatives = page_parser(
        "paper", about, (FOLDER, QUICK_FOLDER), "check all orderings in a minute"
    )
    alternatives.add_argument(
        "--check",
        action="store_true",
        help="compute again what needs no search, and compare it with the folder's results",
    )
    main(parser, reproduce)
