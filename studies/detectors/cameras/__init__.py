"""``python -m studies.detectors --cameras``: the small study of camera placements.

`plan` has what was fixed beforehand, `placements` the rigs; `rendering` gives pictures of the
scenes of the LiDAR study, `lifting` and `network` are the detector, `analysis` draws
the conclusions.
"""
