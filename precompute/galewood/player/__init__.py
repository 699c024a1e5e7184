"""Steps a forest of one table's trees; in: pressure per tree; out: modal coordinates per tree. No I/O."""

from galewood.player.modal_forest import TangentForest
from galewood.player.paper_search import ForestLookup, gaussian
from galewood.player.sway import planted, play

__all__ = ["ForestLookup", "TangentForest", "gaussian", "planted", "play"]
