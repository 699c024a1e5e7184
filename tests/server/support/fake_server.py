"""A server without mesh import, which accepts any upload: `python -m tests.server.support.fake_server`."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from galewood.interrupts import ended_by_interrupts

with ended_by_interrupts(even_if_ignored=True):  # as in `galewood serve`
    from galewood.util import MeshError
    from galewood_server.app.main import create_app, run
    from galewood_server.settings import Settings

if TYPE_CHECKING:  # the package loads scipy, which a fake has no use for
    from galewood.options import ImportRequest


def fake_importer(data: bytes, filename: str, options: ImportRequest) -> Any:
    if not data:
        raise MeshError("empty-file", "malformed", "The file is empty.", "Choose another file.")
    return SimpleNamespace(
        species=options.species,
        height_m=options.height_m or 5.0,
        report={"assumed": ["all"]},
        render_glb=b"glTF" + data[:64],
        tree=b"tree of " + data[:64],
        beams=None,
    )


if __name__ == "__main__":
    settings = Settings()
    run(create_app(settings, fake_importer), settings)
