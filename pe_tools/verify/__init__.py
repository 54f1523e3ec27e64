"""A kit that verifies itself: golden cases by hand and by oracles, and the verb ``verify``."""
