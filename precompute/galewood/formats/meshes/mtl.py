"""Material libraries (MTL) of OBJ files: Kd, d or Tr, map_Kd and map_d; other entries are not drawn.

Colours are taken as sRGB, as three.js does.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from galewood.formats.colours import linear_from_srgb
from galewood.formats.companions import Source, base_name
from galewood.formats.textures import cut_out_by_alpha, drawable, with_alpha
from galewood.formats.types import Material
from galewood.util import shown_text

Json = dict[str, Any]
MAX_LIBRARIES = 20
MAX_MATERIALS = 2_000
OPTION_WORDS = {"-mm": 2, "-o": 3, "-s": 3, "-t": 3}  # words after an option of a map; others have one
OPAQUE_ALPHA = 0.98
NOT_DRAWN = ("map_bump", "bump", "norm", "map_ks", "map_ns", "map_ke", "map_pr", "map_pm", "disp", "refl")


@dataclass
class _Entry:
    colour: list[float] | None = None
    opacity: float = 1.0
    maps: dict[str, str] = field(default_factory=dict[str, str])


def read_libraries(names: list[str], used: set[str], source: Source) -> dict[str, Material]:
    """The used materials by name. Libraries that were not uploaded with the mesh are reported."""
    entries: dict[str, _Entry] = {}
    for name in list(dict.fromkeys(names))[:MAX_LIBRARIES]:
        content = source.files.find(name)
        if content is None:
            source.warn(
                f"The material library {base_name(name)[:80]!r} was not uploaded, so its colours and "
                "textures are missing: upload a ZIP archive with the OBJ, the MTL and the textures."
            )
            continue
        _parse(content.decode("utf-8", errors="replace"), entries)
    found = {name: entry for name, entry in entries.items() if name in used}
    return {name: _material(name, entry, source) for name, entry in found.items()}


def _parse(text: str, entries: dict[str, _Entry]) -> None:
    entry = _Entry()
    for line in text.splitlines():
        words = line.split("#", 1)[0].split()
        if not words:
            continue
        if words[0].lower() == "newmtl":
            if len(entries) >= MAX_MATERIALS:
                return
            entry = entries.setdefault(shown_text(" ".join(words[1:])), _Entry())
            continue
        try:
            _take(entry, words[0].lower(), words[1:])
        except (ValueError, IndexError):
            continue  # one odd line does not spoil the tree


def _take(entry: _Entry, key: str, words: list[str]) -> None:
    if key == "kd":
        values = [float(word) for word in words[:3]]
        entry.colour = values if len(values) == 3 else values[:1] * 3
    elif key == "d":
        entry.opacity = float(words[-1])
    elif key == "tr":
        entry.opacity = 1.0 - float(words[-1])
    elif key.startswith("map_") or key in NOT_DRAWN:
        entry.maps[key] = _map_file(words)


def _map_file(words: list[str]) -> str:
    """The file name of a map, which follows its options and may contain spaces."""
    at = 0
    while at < len(words) - 1 and words[at].startswith("-"):
        option, at = words[at].lower(), at + 1
        for _ in range(OPTION_WORDS.get(option, 1)):
            if at < len(words) - 1 and (option not in OPTION_WORDS or _is_number(words[at])):
                at += 1
    return " ".join(words[at:])


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _material(name: str, entry: _Entry, source: Source) -> Material:
    colour = np.array(entry.colour if entry.colour is not None else [0.8, 0.8, 0.8])
    opacity = entry.opacity if 0.0 < entry.opacity <= 1.0 else 1.0  # some programs write 0 for opaque
    factor = [*linear_from_srgb(colour).tolist(), opacity]
    pbr: Json = {"baseColorFactor": factor, "metallicFactor": 0.0, "roughnessFactor": 1.0}
    found = Material({"name": name, "pbrMetallicRoughness": pbr})
    image = _base_image(entry, source)
    if image is not None:
        found.images["base"] = image
        pbr["baseColorTexture"] = {"index": "base"}
        if entry.colour is None or max(entry.colour) <= 0.0:  # some programs write black beside a texture
            factor[:3] = [1.0, 1.0, 1.0]
        cut_out_by_alpha(found, "base")
    if opacity < OPAQUE_ALPHA and "alphaMode" not in found.json:
        found.json["alphaMode"] = "BLEND"
    unused = sorted(set(entry.maps) - {"map_kd", "map_d", "map_ka"})
    if unused:
        source.warn(f"These maps of the material {name[:80]!r} are not drawn: {', '.join(unused)}.")
    return found


def _base_image(entry: _Entry, source: Source) -> tuple[bytes, str] | None:
    colour, mask = _file(entry, "map_kd", source), _file(entry, "map_d", source)
    shown = drawable(colour, base_name(entry.maps["map_kd"])[:80], source) if colour is not None else None
    if mask is None or mask == colour:
        return shown
    name = base_name(entry.maps["map_d"])[:80]
    return with_alpha(None if shown is None else shown[0], mask, name, source) or shown


def _file(entry: _Entry, key: str, source: Source) -> bytes | None:
    if key not in entry.maps:
        return None
    content = source.files.find(entry.maps[key])
    if content is None:
        source.warn(
            f"The texture {base_name(entry.maps[key])[:80]!r} was not uploaded and is not drawn: upload a "
            "ZIP archive with the OBJ, the MTL and the textures."
        )
    return content
