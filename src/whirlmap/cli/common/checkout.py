"""What only a checkout of the repository has."""

from pathlib import Path

#: The comparison with other integrators, which is not installed with the package.
BENCHMARKS = Path(__file__).parents[4] / "benchmarks"


def has_comparison() -> bool:
    """Whether this is a checkout that holds it."""
    return (BENCHMARKS / "contest").is_dir()
