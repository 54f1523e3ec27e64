"""``python -m studies.detectors.second``: good placements, and equal m with other hardware.

`plan` has what was fixed beforehand and its runs, `analysis` the verdicts, `law` what needs no run.
"""
