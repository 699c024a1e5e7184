"""Mass of drawn twigs: wood too thin to be meshed."""

from __future__ import annotations

import numpy as np

from galewood.tree import RenderPrimitive, Surface, face_components, weld_keeping_faces
from galewood.util import Floats


def twig_volumes(primitive: RenderPrimitive) -> Floats:
    """Volume (n,) m³ of the wood at each vertex: that enclosed by its piece, in equal shares.

    A piece must be closed; open ones count as if their edge were joined to their centre. Flat pieces have no
    volume. The sense in which the faces are wound is of no importance.
    """
    welded = weld_keeping_faces(Surface(primitive.positions_m, primitive.faces))
    count, of_face = face_components(welded.faces, len(welded.vertices))
    piece = np.full(len(primitive.positions_m), count, dtype=np.int64)
    piece[primitive.faces.ravel()] = np.repeat(of_face, 3)
    corners_of = np.bincount(piece, minlength=count + 1)
    centre = np.stack([np.bincount(piece, primitive.positions_m[:, k], count + 1) for k in range(3)], axis=1)
    centre /= np.maximum(corners_of, 1)[:, None]
    a, b, c = np.moveaxis(primitive.positions_m[primitive.faces] - centre[of_face][:, None], 1, 0)
    volume = np.abs(np.bincount(of_face, np.einsum("fi,fi->f", a, np.cross(b, c)) / 6, count + 1))
    volume[count] = 0.0  # vertices without a face
    return np.asarray((volume / np.maximum(corners_of, 1))[piece], dtype=np.float64)
