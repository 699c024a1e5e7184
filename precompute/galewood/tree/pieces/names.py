"""What names of materials, nodes and meshes say, in the languages in which tree models are commonly labelled.

Names are hints: `classification` compares them with colour, shape and position before it follows them.
"""

from __future__ import annotations

import re

from galewood.formats import RawPart
from galewood.tree.types import Kind

WOOD_NAMES = re.compile(
    r"wood|bark|trunk|branch|stem|timber|stump|\blogs?\b|limb|\broots?\b|tronc|stamm|holz|rinde|\bast\b|[äa]e?ste\b"
    r"|wurzel|[ée]corce|corteza|madera|tronco|\brama|legno|corteccia|madeira|casca|\bgalho|schors|\btak|bast\b"
    r"|g[öo]vde|kabuk|\bkora\b|k[ůu]ra|kmen|\bpie[ńn]\b|drewno|ga[łl][ąe][źz]|кора|ствол|ветв|ветк|дерев[яо]нн"
    r"|древесин|幹|枝|樹皮|树皮|树干|樹幹|木材|木头|줄기|나무껍질|가지",
    re.I,
)
TWIG_NAMES = re.compile(r"twig|zweig|brindille", re.I)
LEAF_NAMES = re.compile(
    r"leaf|leaves|leafs|foliage|frond|needle|blossom|flower|petal|fruit|crown|canopy|(?<!ever)green(?!land|house)|grass(?!land)|bush|snow|feuill|blatt"
    r"|bl[äa]e?tter|laub|nadel|krone|bl[üu]e?te|\bhojas?\b|follaje|foglia|foglie|folha|\bblad|yaprak|listí|\bli[śs][ćc]"
    r"|л[иi]ст|хво[яй]|крон|叶|葉|花|树冠|樹冠|잎|꽃",
    re.I,
)
OTHER_NAMES = {
    "ground": re.compile(
        r"ground|terrain|\bfloor|landscape|\bsoil|\bdirt\b|boden\b|erde\b|\bsol\b|suelo|terreno"
        r"|земл|地面",
        re.I,
    ),
    "pot": re.compile(r"\bpot\b|flowerpot|planter|\bvase\b|topf|k[üu]bel|maceta|vaso\b|горшок|花盆", re.I),
    "island": re.compile(r"island|insel\b|[îi]le\b|isla\b|остров", re.I),
    "rock": re.compile(
        r"\brocks?\b|stone|boulder|cliff|pebble|felsen?\b|stein|rocher|piedra|\bскала|камен|岩|石", re.I
    ),
    "fence": re.compile(r"fence|railing|\bgate\b|zaun|cl[ôo]ture|\bvalla|забор|フェンス", re.I),
    "object": re.compile(
        r"bench|house|lamp|skybox|backdrop|pedestal|\bsky\b|collider|collision|\bucx\b", re.I
    ),
}
DEFAULT_NAMES = re.compile(
    r"\s*(?:(?:root|scene|gltf|sketchfab|armature|joint|model|rig|skeleton) ?)*"
    r"(?:plane|cube|box|(?:uv|ico|quad|geo)? ?sphere|circle|cylinder|cone|torus|grid|suzanne|line|rectangle"
    r"|(?:bezier ?)?curve|nurbs ?path|text|empty|null|dummy|locator|object|obj|mesh|sub ?mesh|geometry|geom"
    r"|shape|surface|solid|poly(?:gon| ?surface)?|body|p ?(?:plane|cube|sphere|cylinder|cone|torus)|group"
    r"|node|primitive|layer|root|model|instance|part|element|component|material|mat|standard(?: ?surface)?"
    r"|(?:no|default|initial) ?(?:name|material|shading ?group)?|lambert|blinn|phong|shader|unnamed|untitled"
    r"|none|lod) ?(?:shape|mesh|node|material|mat|obj|object|lod)?\s*",
    re.I,
)
"""Names that modelling tools and converters give by default, without numbers: they say nothing."""
OWN_NAME_PATTERN = re.compile(r"(wood|twigs|leaves)_\d+$")
"""Names that the render GLB of an import has."""


def named_kind(label: str) -> Kind | None:
    """What a name says; None if it says nothing, or both wood and leaves. Branches and twigs are wood."""
    text = spaced_name(label)
    if DEFAULT_NAMES.fullmatch(text):
        return None
    is_wood, is_leaf = WOOD_NAMES.search(text), LEAF_NAMES.search(text)
    if is_wood and is_leaf:
        return None
    if is_wood or is_leaf:
        return "wood" if is_wood else "leaves"
    return "twigs" if TWIG_NAMES.search(text) else None


def named_other(label: str) -> str | None:
    """The kind of object that is not a tree, if a name says so and mentions no part of a tree."""
    text = spaced_name(label)
    if named_kind(label) is not None or DEFAULT_NAMES.fullmatch(text):
        return None
    return next((what for what, pattern in OTHER_NAMES.items() if pattern.search(text)), None)


def spaced_name(label: str) -> str:
    """A name in which CamelCase, hyphens, underscores, dots and digits separate words."""
    return re.sub(r"[-_\d.]+|(?<=[a-z])(?=[A-Z])", " ", label)


def own_kind(part: RawPart) -> Kind | None:
    """The kind of a part that an earlier import has written."""
    found = [match for label in part.labels if (match := OWN_NAME_PATTERN.match(label))]
    if not found:
        return None
    word = found[-1].group(1)
    return "wood" if word == "wood" else "twigs" if word == "twigs" else "leaves"
