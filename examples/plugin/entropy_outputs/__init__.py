"""Outputs of the scene that perception entropy finds by entry points."""
