"""Text from files and requests, made fit to be stored and shown; every reader cleans it where it enters.

A character that cannot be encoded (a lone surrogate), that controls a terminal or a line, that changes the
direction of its surroundings or that is invisible becomes its code, such as <U+202E>: what is shown cannot
pretend to be something else, and names that differ stay different.
"""

from __future__ import annotations

import hashlib
import re
import unicodedata

LONGEST_NAME = 200  # characters, like the next
LONGEST_MESSAGE = 4_000
_DIGEST_BYTES = 4
# controls, formats (directions, zero width), surrogates, separators of lines and paragraphs
_CATEGORIES = frozenset(("Cc", "Cf", "Cs", "Zl", "Zp"))
# letters and marks that leave nothing visible, and selectors of variants that no font has
_BLANK = re.compile("[\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180d\u180f\u3164\uffa0\U000e0000-\U000e0fff]")


def shown_text(text: str, longest: int = LONGEST_NAME) -> str:
    """The text with unfit characters as their codes, in at most ``longest`` characters (32 or more).

    Line breaks and tabs become blanks. A longer text ends with a digest of the whole, so that texts with the
    same beginning stay different. Cleaning a clean text changes nothing.
    """
    if text.isascii() and text.isprintable() and len(text) <= longest:
        return text
    shown = "".join(_shown(char) for char in text[: longest + 1])
    if len(shown) <= longest and len(text) <= longest:
        return shown
    end = f"… {_digest(text)}"
    return f"{shown[: longest - len(end)]}{end}"


def shown_message(text: str) -> str:
    """A sentence that may quote files, such as a warning: clean, and not longer than can be read."""
    return shown_text(text, LONGEST_MESSAGE)


def _shown(char: str) -> str:
    if char in "\t\n\r":
        return " "
    if unicodedata.category(char) in _CATEGORIES or _BLANK.match(char):
        return f"<U+{ord(char):04X}>"
    return char


def _digest(text: str) -> str:
    return hashlib.blake2s(text.encode("utf-8", "surrogatepass"), digest_size=_DIGEST_BYTES).hexdigest()
