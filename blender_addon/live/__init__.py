"""The score that follows the hand."""
