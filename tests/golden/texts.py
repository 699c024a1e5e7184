"""Golden files of text files that a visitor may drop: what is read from each, and the errors of others."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any


def refused(name: str, text: str, read: Callable[[bytes], Any], error: type[Exception]) -> dict[str, str]:
    """The error of a file that is refused."""
    try:
        read(text.encode())
    except error as fault:
        return {"name": name, "text": text, "error": str(fault)}
    raise AssertionError(f"not refused: {name}")


def write_golden(path: Path, golden: dict[str, Any]) -> None:
    """Write a golden file."""
    path.write_text(json.dumps(golden, separators=(",", ":"), ensure_ascii=False) + "\n")
