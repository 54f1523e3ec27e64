"""What tests of the engine and of the tools share."""

from tests.few_errors import few_errors

__all__ = ["few_errors"]
