"""Candidate lists of the paper's state search; in: internal states of all records; out: exact candidates."""

from galewood.motion.search.candidates import Rule, air_of, build_search, last_records, still_records
from galewood.motion.search.similarity import Compared, InternalStates, compared, mismatch_rows, typical_error

__all__ = [
    "Compared",
    "InternalStates",
    "Rule",
    "air_of",
    "build_search",
    "compared",
    "last_records",
    "mismatch_rows",
    "still_records",
    "typical_error",
]
