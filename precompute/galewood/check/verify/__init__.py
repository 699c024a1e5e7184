"""Verification of the physics against exact solutions, beam theory and the reference elements."""

from galewood.check.verify.run import Scope, insert_table, run_checks

__all__ = ["Scope", "insert_table", "run_checks"]
