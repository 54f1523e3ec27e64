"""Layers of the 3D view: beams and what blocks them, camera views, ground map, reach, marks."""
