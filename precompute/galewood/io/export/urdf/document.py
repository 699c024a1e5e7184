"""The URDF document of a fitted tree.

URDF knows joints of one axis only: a body that bends in two directions and twists hangs on three of them,
through two small links. It knows no springs: the description beside the document has them.
"""

from __future__ import annotations

from collections.abc import Set
from xml.etree import ElementTree

import numpy as np

from galewood.io.export.rigid.bodies import GROUND_BODY, HINGES, body_names, upright, upright_tensor
from galewood.io.export.rigid.fitted import FittedTree
from galewood.util import Floats

WORLD_LINK = "world"
"""The name by which simulators know what does not move."""
SMALL_SHARE = 0.01
"""Of mass and inertia of a body, on each of the two links between its joints: simulators refuse or shake what
has none. Together the three links weigh as much as the body."""
MOST_TURN_RAD = float(np.pi)
MOST_RATE_RAD_S = 100.0
GROUND_INERTIA_KG_M2 = 1.0
"""Of the foot of the stem, which does not turn."""


def document(fitted: FittedTree, capsules: Floats, drawn: Set[int], name: str) -> str:
    """The XML text. ``capsules`` (c, 8): body, ends (2 × 3, axes of the table), radius, written as cylinders.

    ``drawn``: bodies with a mesh, ``mesh_file`` of their names.
    """
    root = ElementTree.Element("robot", name=name)
    # MuJoCo would melt the foot of the stem into its world
    ElementTree.SubElement(ElementTree.SubElement(root, "mujoco"), "compiler", fusestatic="false")
    tree, names, origin = fitted.tree, body_names(fitted.tree, name), upright(fitted.tree.hinge_m)
    ElementTree.SubElement(root, "link", name=WORLD_LINK)
    ground = _joined(root, name, WORLD_LINK, "fixed", f"{name}_foot", np.zeros(3))
    _add_inertia(ground, fitted.ground_kg, np.eye(3) * GROUND_INERTIA_KG_M2, np.zeros(3))
    links = {GROUND_BODY: ground}
    for body in range(tree.count):
        above = int(tree.parent[body])
        start = np.zeros(3) if above == GROUND_BODY else origin[above]
        links[body] = _add_body(root, fitted, body, names, origin[body] - start)
    for body, link in links.items():
        start = np.zeros(3) if body == GROUND_BODY else origin[body]
        if body in drawn:
            visual = ElementTree.SubElement(link, "visual")
            _add_origin(visual, np.zeros(3))
            mesh = ElementTree.SubElement(visual, "geometry")
            ElementTree.SubElement(mesh, "mesh", filename=mesh_file(names[body]))
        for row in capsules[capsules[:, 0] == body]:
            _add_cylinder(link, upright(row[1:7].reshape(2, 3)) - start, float(row[7]))
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def mesh_file(name: str) -> str:
    """The file with what is drawn of a body."""
    return f"{name}.obj"


def _add_body(
    root: ElementTree.Element, fitted: FittedTree, body: int, names: list[str], place_m: Floats
) -> ElementTree.Element:
    """The link of a body, behind its three joints and the two links between them."""
    tree, masses, name = fitted.tree, fitted.masses, names[body]
    held = names[int(tree.parent[body])]
    link, centre = root, upright(masses.centre_m[body]) - upright(tree.hinge_m[body])
    inertia = upright_tensor(masses.inertia[body])
    for axis, hinge in enumerate(HINGES):
        last = axis == len(HINGES) - 1
        own = name if last else f"{name}_{hinge}"
        link = _joined(root, own, held, "revolute", f"{name}_{hinge}", place_m if axis == 0 else np.zeros(3))
        share = 1 - (len(HINGES) - 1) * SMALL_SHARE if last else SMALL_SHARE
        _add_inertia(link, share * float(masses.mass_kg[body]), share * inertia, centre)
        joint = root[-1]
        ElementTree.SubElement(joint, "axis", xyz=_text(upright(tree.axes[body, axis])))
        number = 3 * body + axis
        ElementTree.SubElement(
            joint, "dynamics", damping=_text(fitted.damping[number : number + 1]), friction="0"
        )
        most = _text(np.array([MOST_TURN_RAD]))
        ElementTree.SubElement(
            joint, "limit", lower=f"-{most}", upper=most, velocity=_text(np.array([MOST_RATE_RAD_S])),
            effort=_text(MOST_TURN_RAD * fitted.stiffness[number : number + 1]),
        )  # fmt: skip
        held = own
    return link


def _joined(
    root: ElementTree.Element, name: str, parent: str, kind: str, joint_name: str, place_m: Floats
) -> ElementTree.Element:
    """A link, and behind it in the document the joint that holds it."""
    link = ElementTree.SubElement(root, "link", name=name)
    joint = ElementTree.SubElement(root, "joint", name=joint_name, type=kind)
    ElementTree.SubElement(joint, "parent", link=parent)
    ElementTree.SubElement(joint, "child", link=name)
    _add_origin(joint, place_m)
    return link


def _add_inertia(link: ElementTree.Element, mass_kg: float, inertia: Floats, centre_m: Floats) -> None:
    inertial = ElementTree.SubElement(link, "inertial")
    _add_origin(inertial, centre_m)
    ElementTree.SubElement(inertial, "mass", value=_text(np.array([mass_kg])))
    axes = "xyz"
    values = {
        f"i{axes[row]}{axes[column]}": _text(inertia[row, column : column + 1])
        for row in range(3)
        for column in range(row, 3)
    }
    ElementTree.SubElement(inertial, "inertia", values)


def _add_cylinder(link: ElementTree.Element, ends_m: Floats, radius_m: float) -> None:
    """A cylinder between two places; URDF has it along z, turned about y and then about z."""
    along = ends_m[1] - ends_m[0]
    length = float(np.linalg.norm(along))
    pitch = np.arctan2(np.hypot(along[0], along[1]), along[2])
    collision = ElementTree.SubElement(link, "collision")
    _add_origin(collision, ends_m.mean(axis=0), np.array([0.0, pitch, np.arctan2(along[1], along[0])]))
    geometry = ElementTree.SubElement(collision, "geometry")
    ElementTree.SubElement(geometry, "cylinder", radius=f"{radius_m:.7g}", length=f"{length:.7g}")


def _add_origin(element: ElementTree.Element, place_m: Floats, turn_rad: Floats | None = None) -> None:
    turned = {} if turn_rad is None else {"rpy": _text(turn_rad)}
    ElementTree.SubElement(element, "origin", {"xyz": _text(place_m), **turned})


def _text(values: Floats) -> str:
    return " ".join(f"{value:.7g}" for value in values)
