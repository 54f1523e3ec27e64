"""Sweeps: many studies, or one with many changes, run by the workers of any executor."""
