"""``python -m studies.detectors --after-search``: detectors before and after the default search.

`plan` has what was fixed beforehand, `searches` runs the searches and keeps their placements,
`study` has the runs and draws the conclusions, `section` shows them.
"""
