"""The MJCF document of a fitted tree."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np

from galewood.io.export.mjcf.skin import Skin
from galewood.io.export.rigid.bodies import GROUND_BODY, HINGES, body_names, upright, upright_tensor
from galewood.io.export.rigid.drag import AIR_KG_M3, SPHERE_M, STEP_S, drag_coefficients
from galewood.io.export.rigid.fitted import FittedTree
from galewood.util import Floats

MUJOCO_INTEGRATOR = "Euler"
"""Implicit in the damping of the joints. "implicitfast" also differentiates the fluid forces, by all pairs of
joints, and takes 50 times as long."""
COLLISION_GROUP = 3
"""Group of the capsules: viewers hide it at first."""
DRAG_GROUP = 4


def document(fitted: FittedTree, capsules: Floats, skins: list[Skin], name: str, height_m: float) -> str:
    """The XML text. ``capsules`` (c, 8): body, ends (2 × 3, axes of the table), radius."""
    root = ElementTree.Element("mujoco", model=name)
    ElementTree.SubElement(root, "compiler", angle="radian", autolimits="true")
    ElementTree.SubElement(
        root, "option", timestep=f"{STEP_S:g}", integrator=MUJOCO_INTEGRATOR, density=f"{AIR_KG_M3:g}"
    )
    ElementTree.SubElement(root, "statistic", center=f"0 0 {height_m / 2:g}", extent=f"{height_m:g}")
    _add_defaults(root, name)
    _add_assets(ElementTree.SubElement(root, "asset"), skins)
    _add_bodies(ElementTree.SubElement(root, "worldbody"), fitted, capsules, name)
    deformable = ElementTree.SubElement(root, "deformable")
    for skin in skins:
        ElementTree.SubElement(deformable, "skin", name=skin.name, file=skin.file, material=skin.name)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _add_defaults(root: ElementTree.Element, name: str) -> None:
    tree = ElementTree.SubElement(ElementTree.SubElement(root, "default"), "default", {"class": name})
    ElementTree.SubElement(tree, "joint", type="hinge")
    wood = ElementTree.SubElement(tree, "default", {"class": f"{name}_wood"})
    # the tree meets other things, not itself
    ElementTree.SubElement(
        wood, "geom", type="capsule", mass="0", contype="0", conaffinity="1", group=str(COLLISION_GROUP)
    )
    drag = ElementTree.SubElement(tree, "default", {"class": f"{name}_drag"})
    ElementTree.SubElement(
        drag, "geom", type="sphere", size=f"{SPHERE_M:g}", mass="0", contype="0", conaffinity="0",
        fluidshape="ellipsoid", group=str(DRAG_GROUP), rgba="0 0 1 0.3",
    )  # fmt: skip


def _add_assets(asset: ElementTree.Element, skins: list[Skin]) -> None:
    for skin in skins:
        rgba = _text(np.array(skin.rgba))
        look = {"name": skin.name, "rgba": rgba, "specular": "0.1", "shininess": "0.1"}
        if skin.texture is not None:
            ElementTree.SubElement(asset, "texture", name=skin.name, type="2d", file=skin.texture)
            look["texture"] = skin.name
        ElementTree.SubElement(asset, "material", look)


def _add_bodies(world: ElementTree.Element, fitted: FittedTree, capsules: Floats, name: str) -> None:
    tree, names = fitted.tree, body_names(fitted.tree, name)
    ground = ElementTree.SubElement(world, "body", name=name, childclass=name)
    # the weight on the ground is that of the whole tree
    if fitted.ground_kg > 0:
        ElementTree.SubElement(
            ground, "inertial", pos="0 0 0", mass=f"{fitted.ground_kg:.7g}", diaginertia="1 1 1"
        )
    elements, origin = list[ElementTree.Element](), upright(tree.hinge_m)
    drag = drag_coefficients(fitted.area_m2)
    for body in range(tree.count):
        above = int(tree.parent[body])
        held, start = (ground, np.zeros(3)) if above == GROUND_BODY else (elements[above], origin[above])
        element = ElementTree.SubElement(held, "body", name=names[body], pos=_text(origin[body] - start))
        elements.append(element)
        _add_inertia(element, fitted, body, origin[body])
        _add_hinges(element, fitted, body, names[body])
        ElementTree.SubElement(
            element, "geom", {"class": f"{name}_drag"},
            pos=_text(upright(fitted.area_centre_m[body]) - origin[body]),
            fluidcoef=_text(np.array([drag[body], 0.0, 0.0, 0.0, 0.0])),
        )  # fmt: skip
    for row in capsules:
        body = int(row[0])
        held, start = (ground, np.zeros(3)) if body == GROUND_BODY else (elements[body], origin[body])
        ends = upright(row[1:7].reshape(2, 3)) - start
        ElementTree.SubElement(
            held, "geom", {"class": f"{name}_wood"}, fromto=_text(ends.ravel()), size=_text(row[7:])
        )


def _add_inertia(element: ElementTree.Element, fitted: FittedTree, body: int, origin: Floats) -> None:
    masses = fitted.masses
    inertia = upright_tensor(masses.inertia[body])
    ElementTree.SubElement(
        element, "inertial",
        pos=_text(upright(masses.centre_m[body]) - origin), mass=_text(masses.mass_kg[body : body + 1]),
        fullinertia=_text(inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]),
    )  # fmt: skip


def _add_hinges(element: ElementTree.Element, fitted: FittedTree, body: int, name: str) -> None:
    for axis, kind in enumerate(HINGES):
        hinge = 3 * body + axis
        values = (fitted.stiffness[hinge], fitted.damping[hinge], fitted.reference_rad[hinge])
        stiffness, damping, reference = (_text(np.array([value])) for value in values)
        ElementTree.SubElement(
            element, "joint", name=f"{name}_{kind}", axis=_text(upright(fitted.tree.axes[body, axis])),
            stiffness=stiffness, damping=damping, springref=reference,
        )  # fmt: skip


def _text(values: Floats) -> str:
    return " ".join(f"{value:.7g}" for value in values)
