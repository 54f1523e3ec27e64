"""``python -m studies.published``: the scores, compared with published results of detectors.

`published` has the placements and results, `scores` what is compared with them, `tasks` what is
computed, `ranks` and `correlations` the statistics, `page`, `findings` and `plots` show them.
"""
