"""The fast paths. Each has a plain definition elsewhere that a test holds it to."""
