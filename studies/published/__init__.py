"""``python -m studies.published``: the scores, compared with published results of detectors.

`published` has the placements and results, `scores` what is compared with them, `tasks` what is
computed, `correlations` the statistics; `findings`, `page.md.j2` and `plots` show them.
"""
