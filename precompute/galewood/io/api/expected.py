"""Arguments of another type, such as a path in place of a tree: said at once, with what to do."""

from __future__ import annotations

WAYS_TO = {
    "Tree": 'galewood.read("oak.glb") makes one of a mesh file',
    "MotionTable": 'galewood.load("oak.gwt") makes one of a table file, galewood.build(tree) of a tree',
    "Wind": 'galewood.Wind() and galewood.PRESETS["breeze"] are some',
    "Wood": 'galewood.SPECIES["oak"] is one',
}
"""How a program gets an instance of each class."""


def expect(name: str, value: object, kind: type) -> None:
    """Raise TypeError unless an argument is of the class, one of ``WAYS_TO``; it says how to get one."""
    if not isinstance(value, kind):
        what = kind.__name__
        raise TypeError(f"{name} must be a galewood.{what}, not {value!r:.60}: {WAYS_TO[what]}")
