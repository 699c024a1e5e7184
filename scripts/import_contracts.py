"""Contracts for import-linter beside its own."""

from __future__ import annotations

from typing import Any

from grimp import ImportGraph
from importlinter import Contract, ContractCheck, fields, output


class PublicNamesContract(Contract):
    """A module of one package is imported by modules of that package only.

    Others import the names that the package's ``__init__`` lists in ``__all__``. A package is what lies
    directly below a root package: ``galewood.fem``.
    """

    # import-linter replaces the field by the list read from the settings
    exceptions: Any = fields.ListField(subfield=fields.StringField(), required=False, default=[])

    def check(self, graph: ImportGraph, verbose: bool) -> ContractCheck:
        """Compare every import between packages with the rule."""
        violations = [
            (importer, imported)
            for importer in sorted(graph.modules)
            for imported in sorted(graph.find_modules_directly_imported_by(importer))
            if self._reaches_inside(importer, imported)
        ]
        return ContractCheck(kept=not violations, metadata={"violations": violations})

    def _reaches_inside(self, importer: str, imported: str) -> bool:
        package = imported.split(".")[:2]
        root = importer.split(".")[0]
        inside = imported.count(".") >= 2 and imported.split(".")[0] in ("galewood", "galewood_server")
        if not inside or imported in self.exceptions or root not in ("galewood", "galewood_server"):
            return False
        return importer.split(".")[:2] != package

    def render_broken_contract(self, check: ContractCheck) -> None:
        """Name every import that reaches inside another package."""
        for importer, imported in check.metadata["violations"]:
            package = ".".join(imported.split(".")[:2])
            output.print_error(f"{importer} imports {imported}: import the name from {package}", bold=False)
