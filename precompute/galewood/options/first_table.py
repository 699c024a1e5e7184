"""What a table of beams does not depend on, so that one made with other settings will do."""

from __future__ import annotations

AFTER_BEAMS = frozenset(
    {"target_tets", "sampled_elements", "frames", "paper", "bare_table", "all_cosine_winds", "accept"}
)
"""Settings of a build that only its later stages read."""
