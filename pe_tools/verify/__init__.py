"""A kit that verifies itself: golden cases by hand and by oracles, and the verb ``verify``."""

from .verification import CaseResult, Verification, verify, verify_in_short, verifying
