"""What wind does to trees and stands."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from galewood.io.api.risk.stands import stand_risk
from galewood.io.api.risk.wind_risk import critical_wind, gust_strain, strain

__all__ = ["critical_wind", "gust_strain", "stand_risk", "strain"]
