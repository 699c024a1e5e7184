"""Pictures of a build and thumbnails of trees, as PNG bytes."""

from galewood.pipeline.pictures.drawing import skeleton_png, tetrahedra_png
from galewood.pipeline.pictures.split import check_picture
from galewood.pipeline.pictures.thumbnail import draw_limited

__all__ = ["check_picture", "draw_limited", "skeleton_png", "tetrahedra_png"]
