"""Pictures and films of the documentation; `make figures` draws them."""

from pathlib import Path

DOCS = Path(__file__).parents[1] / "docs"
