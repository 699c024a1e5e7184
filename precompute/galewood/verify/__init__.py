"""Verification of the physics against exact solutions, beam theory and the reference elements."""

from galewood.verify.run import Scope, run_checks, written_into

__all__ = ["Scope", "run_checks", "written_into"]
