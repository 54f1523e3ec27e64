"""Exit statuses, and what a verb answers."""

DONE, BAD_INPUT, USAGE, INTERRUPTED = 0, 1, 2, 130
Answer = tuple[str, int]
"""What a verb prints on stdout, and its exit status."""
