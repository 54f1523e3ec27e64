"""``pe validate``: the scores held against what trained detectors were published to reach."""
