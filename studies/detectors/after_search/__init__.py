"""``python -m studies.detectors --after-search``: detectors before and after the default search.

`plan` has what was fixed beforehand, `searches` runs the searches and keeps their placements,
`analysis` draws the conclusions.
"""
