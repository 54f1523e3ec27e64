"""``pe fit`` and ``pe front``: a fit of an AP curve and a Pareto front, drawn by matplotlib."""
