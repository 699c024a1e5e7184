"""wind.json: which bones of a tree Unreal's Dynamic Wind plug-in moves as trunk, branches and twigs.

The fields are those of FDynamicWindSkeletalImportData (Unreal Engine 5.7 API reference: joints with a
simulation group index, groups with influence and a mark for the trunk, ground cover, gust attenuation). The
reference gives no units: influences are relative here, by how far the table turns the bones of a group.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from galewood.io.export.skeletal.joints import RigidMotion
from galewood.io.export.skeletal.skeleton import Skeleton, branch_of_node, levels
from galewood.table import Table
from galewood.util import Ints

GROUP_COUNT = 4


def wind_groups(table: Table, skeleton: Skeleton, motion: RigidMotion) -> dict[str, Any]:
    """The document for a skeleton whose bones move by ``motion``."""
    branch, parent_branch = branch_of_node(table)
    group = np.minimum(levels(parent_branch)[branch[skeleton.node]], GROUP_COUNT - 1)
    influence = _influence(group, motion)
    return {
        "Joints": [
            {"JointName": name, "SimulationGroupIndex": int(index)}
            for name, index in zip(skeleton.name, group, strict=True)
        ],
        "SimulationGroups": [
            {
                "bUseDualInfluence": False,
                "Influence": round(share, 3),
                "MinInfluence": 0.0,
                "MaxInfluence": 0.0,
                "ShiftTop": 0.0,
                "bIsTrunkGroup": index == 0,
            }
            for index, share in enumerate(influence)
        ],
        "bIsGroundCover": False,
        "GustAttenuation": 0.0,
    }


def _influence(group: Ints, motion: RigidMotion) -> list[float]:
    """RMS turning of the bones of each group over that of the group that turns most."""
    turn = np.sqrt(np.square(motion.rotation[:, :, :3]).sum(axis=2).mean(axis=0))
    each = [float(turn[group == index].mean()) for index in range(int(group.max()) + 1)]
    most = max(each) or 1.0
    return [value / most for value in each]
