"""Tests of the whole package with its compiled part, by pytest. ``unittest`` runs those of the messages only."""

from typing import Any


def load_tests(loader: Any, tests: Any, pattern: Any) -> Any:
    """Ends unittest's discovery here: these need the wheel, NumPy and pytest."""
    return tests
