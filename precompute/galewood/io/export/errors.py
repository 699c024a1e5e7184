"""What goes wrong in an export."""


class ExportError(ValueError):
    """A tree that cannot be exported as asked: the mesh, an option or a missing package; says what to do."""
