"""Files that are no mesh, or one that cannot be read: named by their content, with what to do instead."""

from __future__ import annotations

import re

from galewood.util import MeshError

ACCEPTED_HINT = (
    "Upload a GLB, OBJ, PLY, STL, FBX, DAE or 3DS file, a ZIP archive of a model with its textures, or the "
    "cylinders of a scanned tree (MAT, CSV)."
)
AS_GLB = "Open it in Blender or another modelling program and export it as GLB (glTF Binary)."
POINT_CLOUD_HINT = (
    "A point cloud has no surface. Fit cylinders to it (TreeQSM, SimpleForest, AdTree) and upload those, or "
    "make a mesh of it (in MeshLab: Screened Poisson)."
)
MODELS = {
    b"BLENDER": "a Blender file",
    b"PXR-USDC": "a USD file",
    b"#usda": "a USD file",
    b"ISO-10303-21": "a STEP file",
    b"xof ": "a DirectX file",
    b"#VRML": "a VRML file",
    b"Ogawa": "an Alembic file",
    b"FORM": "a LightWave file",
    b"OFF": "an OFF file",
}
CLOUDS = {
    b"LASF": "LAS or LAZ",
    b"ASTM-E57": "E57",
    b"# .PCD": "PCD",
    b"VERSION .7\nFIELDS": "PCD",
}
OTHERS = {
    b"%PDF": "a PDF", b"\x89PNG": "a PNG image", b"\xff\xd8\xff": "a JPEG image", b"GIF8": "a GIF image",
    b"RIFF": "a WebP image or a recording", b"\xabKTX": "a KTX image", b"DRACO": "a bare Draco stream",
    b"\x1f\x8b": "a gzip file", b"BZh": "a bzip2 file", b"7z\xbc\xaf": "a 7z archive",
    b"Rar!": "a RAR archive", b"\xfd7zXZ": "an xz file", b"\x28\xb5\x2f\xfd": "a Zstandard file",
    b"\x7fELF": "a program", b"MZ": "a program", b"<": "an HTML or XML page",
}  # fmt: skip
NUMBERS_PATTERN = re.compile(r"^\s*[-+.\deE]+([\s,;]+[-+.\deE]+){2,}\s*$")
SAMPLE_LINES = 20


def refuse_foreign(data: bytes) -> None:
    """MeshError if the file begins like one of another kind."""
    head = data[:64].lstrip(b"\xef\xbb\xbf \t\r\n")
    for magic, what in MODELS.items():
        if head.startswith(magic):
            raise _unsupported(f"The file is {what}, which cannot be read.", AS_GLB)
    for magic, what in CLOUDS.items():
        if head.startswith(magic):
            raise point_cloud(f"The file is a point cloud ({what}).")
    for magic, what in OTHERS.items():
        if head.startswith(magic):
            raise _unsupported(f"The file is {what}, not a mesh.", ACCEPTED_HINT)


def refuse_points(data: bytes) -> None:
    """MeshError if the file is a table of numbers, as point clouds are (XYZ, PTS, ASC)."""
    lines = data[:8192].decode("latin-1").splitlines()[:-1][: SAMPLE_LINES + 1]
    rows = [line for line in lines[1:] if line.strip()]  # the first line may be a count or a heading
    if len(rows) >= 3 and all(NUMBERS_PATTERN.match(line) for line in rows):
        raise point_cloud("The file is a table of points, not a mesh.")


def point_cloud(title: str) -> MeshError:
    """The error for a file that holds points without faces."""
    return MeshError("point-cloud", "unsupported", title, POINT_CLOUD_HINT)


def _unsupported(title: str, hint: str) -> MeshError:
    return MeshError("unsupported-type", "unsupported", title, hint)
