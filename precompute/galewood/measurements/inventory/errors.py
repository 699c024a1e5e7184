"""The error of an inventory that cannot be read."""

from __future__ import annotations

from galewood.util import shown_message


class InventoryError(ValueError):
    """A file that is no usable inventory: what is wrong and what to do."""

    def __init__(self, message: str) -> None:
        super().__init__(shown_message(message))
