"""Steps the trees of one table; in: pressure per tree; out: modal coordinates per tree. No I/O."""

from galewood.player.modal_forest import ModalForest
from galewood.player.paper_search import PaperForest, gaussian
from galewood.player.periodic import PERIOD_START_S, periodic_motion
from galewood.player.pulling import DragConstraint, PointResponse, PullError, point_response
from galewood.player.recording import record_points
from galewood.player.sway import grid_placements, play
from galewood.player.wind_driven import WindDrivenTrees
from galewood.player.wind_driven_forest import WindDrivenForest

__all__ = [
    "PERIOD_START_S",
    "DragConstraint",
    "ModalForest",
    "PaperForest",
    "PointResponse",
    "PullError",
    "WindDrivenForest",
    "WindDrivenTrees",
    "gaussian",
    "grid_placements",
    "periodic_motion",
    "play",
    "point_response",
    "record_points",
]
