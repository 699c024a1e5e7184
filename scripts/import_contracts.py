"""Contracts for import-linter beside its own."""

from __future__ import annotations

from typing import Any

from grimp import ImportGraph
from importlinter import Contract, ContractCheck, fields, output


class PublicNamesContract(Contract):
    """A module of one package is imported by modules of that package only.

    Others import the names that the package's ``__init__`` lists in ``__all__``. A package is what lies
    directly below a root package or a group of packages: ``galewood.table``, ``galewood.solid.fem``.
    """

    # import-linter replaces the field by the list read from the settings
    groups: Any = fields.ListField(subfield=fields.StringField(), required=False, default=[])
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
        package = self._package_of(imported)
        ours = {name.split(".")[0] for name in (importer, imported)} <= {"galewood", "galewood_server"}
        if not ours or imported in (package, *self.exceptions):
            return False
        return self._package_of(importer) != package

    def _package_of(self, module: str) -> str:
        """The package of a module; a group itself stands for what it holds."""
        names = module.split(".")
        return ".".join(names[: 3 if ".".join(names[:2]) in self.groups else 2])

    def render_broken_contract(self, check: ContractCheck) -> None:
        """Name every import that reaches inside another package."""
        for importer, imported in check.metadata["violations"]:
            package = self._package_of(imported)
            output.print_error(f"{importer} imports {imported}: import the name from {package}", bold=False)
