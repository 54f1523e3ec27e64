"""``pe validate --own``: our own study of placements and detectors.

`plan` has what was fixed beforehand, `placements` the rigs.
"""
