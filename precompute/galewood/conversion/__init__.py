"""Text files of measurements (inventories, anemometer records) to the JSON that page and player read."""

from galewood.conversion.data_file import UnknownContentError, read_data_file
from galewood.conversion.limited import convert_limited

__all__ = ["UnknownContentError", "convert_limited", "read_data_file"]
