"""``python -m studies.detectors.frames``: a detector with one frame and with several, in motion.

`plan` has what was fixed beforehand, `moving` the scenes, `analysis` the verdicts.
"""
