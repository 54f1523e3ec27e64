"""Names of the files in a folder of results."""

RESULT = "result.json"
HISTORY = "history.csv"
STUDY = "study.toml"
MESH = "vehicle.npz"
AREAS = "areas.npz"
"""Mesh file with the areas of mounts, one part for each mount."""
BOXES = "boxes.csv"
"""File of labelled boxes beside a study, when they have no file of their own."""
GRID = "prior.npy"
"""File of a prior's weights beside a study, when they have no file of their own."""
OPTIMIZED = "optimized.blend"  # The file that Blender adds
REVIEW_PAGE = "review.html"  # The review page
SEARCH = "search.json"  # Checkpoint of a search, from which it can be resumed
BESIDE_RESULT = (STUDY, MESH, AREAS, BOXES, GRID, HISTORY, SEARCH, OPTIMIZED, REVIEW_PAGE)
"""All files that belong to a result.json."""
SCHEMA = 1  # Version of the schema of result.json
