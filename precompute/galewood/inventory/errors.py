"""The error of an inventory that cannot be read."""

from __future__ import annotations


class InventoryError(ValueError):
    """A file that is no usable inventory: what is wrong and what to do."""
