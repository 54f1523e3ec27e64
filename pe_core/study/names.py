"""Names of the files that a run leaves in its output folder."""

RESULT, HISTORY, STUDY, MESH = "result.json", "history.csv", "study.toml", "vehicle.npz"
AREAS = "areas.npz"
"""Areas of the body that sensors are mounted on, a part a mount."""
BOXES = "boxes.csv"
"""The name boxes get beside a study when they have no file of their own."""
OPTIMIZED, REVIEW = "optimized.blend", "review.png"
"""What Blender adds."""
REVIEW_PAGE = "review.html"
"""What `pe_review` makes of it."""
SEARCH = "search.json"
"""The state of a search: from it, it goes on."""
BESIDE_RESULT = (STUDY, MESH, AREAS, BOXES, HISTORY, SEARCH, OPTIMIZED, REVIEW, REVIEW_PAGE)
"""All that belongs to a result.json."""
SCHEMA = 1
"""Of result.json."""
