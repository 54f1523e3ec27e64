"""Benchmarks: our kernels against a yardstick in the same run. ``python -m benchmarks``."""
