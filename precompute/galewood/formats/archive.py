"""ZIP archives with one model and the files it refers to. Every entry is checked before one is unpacked."""

from __future__ import annotations

import io
import posixpath
import stat
import zipfile
import zlib
from dataclasses import dataclass

from galewood.formats.companions import base_name, local_name
from galewood.formats.limits import MAX_BYTES
from galewood.util import MeshError

MAX_ENTRIES = 2_000
MAX_RATIO = 200  # of unpacked to packed size; text compresses up to about 30 times
SMALL_BYTES = 32 << 20  # the ratio of smaller entries is not checked: plain textures compress well
ENCRYPTED_FLAG = 0x1
# in the order of preference if an archive holds one model in several formats
MODELS = (".glb", ".gltf", ".fbx", ".dae", ".obj", ".3ds", ".ply", ".stl")
LAST_RESORT = (".mat", ".csv")
UNREADABLE_SUFFIXES = (".blend", ".usdc", ".usda", ".usdz", ".usd", ".max", ".ma", ".mb", ".c4d", ".abc")
ARCHIVES = (".zip", ".7z", ".rar", ".tar", ".gz", ".tgz", ".usdz")
HIDDEN_PREFIXES = ("__macosx/", "._")
ARCHIVE_HINT = "Put one GLB, or one glTF, OBJ or FBX file with its textures, into a ZIP archive."


class Archive:
    """An archive whose entries have been checked. Raises MeshError if one of them is unacceptable."""

    def __init__(self, data: bytes) -> None:
        try:
            self._zip = zipfile.ZipFile(io.BytesIO(data))
        except (zipfile.BadZipFile, ValueError, NotImplementedError, OverflowError) as error:
            raise _broken("The ZIP archive cannot be read.") from error
        entries = [entry for entry in self._zip.infolist() if not entry.is_dir()]
        if len(entries) > MAX_ENTRIES:
            raise MeshError(
                "zip-entries", "too-large",
                f"The ZIP archive has {len(entries)} files; the limit is {MAX_ENTRIES}.", ARCHIVE_HINT,
            )  # fmt: skip
        for entry in entries:
            _check(entry)
        self._entries = {entry.filename.replace("\\", "/"): entry for entry in entries}
        self._room = MAX_BYTES

    def names(self) -> list[str]:
        """Names of all files, sorted."""
        return sorted(self._entries)

    def read(self, name: str) -> bytes:
        """The unpacked content of a file; MeshError if it is damaged or all files together are too large."""
        entry = self._entries[name]
        self._room -= entry.file_size
        if self._room < 0:
            raise _too_large()
        try:
            return self._zip.read(entry)
        except (
            zipfile.BadZipFile,
            zlib.error,
            EOFError,
            NotImplementedError,
            OSError,
            RuntimeError,
        ) as error:
            raise _broken(f"{_short(name)!r} in the ZIP archive cannot be unpacked.") from error


@dataclass
class ArchiveFolder:
    """The files of an archive as seen by a model in one of its folders."""

    archive: Archive
    folder: str

    def find(self, name: str) -> bytes | None:
        """By the relative path, else by the base name alone if only one file has it."""
        path = local_name(name, self.folder)
        names = self.archive.names()
        if path in names:
            return self.archive.read(path)
        wanted = base_name(name)
        matches = [n for n in names if base_name(n) == wanted]
        return self.archive.read(matches[0]) if len(matches) == 1 else None


def model_in(archive: Archive) -> tuple[str, list[str]]:
    """The name of the only model in an archive, and warnings about the files that are not used.

    Raises MeshError if there is none, or several of different names.
    """
    names = [name for name in archive.names() if not _is_hidden(name)]
    models = _of(names, MODELS) or _of(names, LAST_RESORT)
    if not models:
        raise _no_model(names)
    stems = {posixpath.splitext(base_name(name))[0] for name in models}
    best = min(models, key=lambda name: ((*MODELS, *LAST_RESORT).index(_suffix(name)), name.count("/"), name))
    same = [name for name in models if _suffix(name) == _suffix(best)]
    if len(same) > 1 or (len(stems) > 1 and _suffix(best) not in (".glb", ".gltf")):
        raise _several(models)
    warnings = [
        f"The ZIP archive also contains {_short(name)!r}, which is not used: {_short(best)!r} is."
        for name in models
        if name != best
    ]
    warnings += [
        f"The archive {_short(name)!r} inside the ZIP is not opened." for name in _of(names, ARCHIVES)
    ]
    return best, warnings


def _check(entry: zipfile.ZipInfo) -> None:
    name = entry.filename
    if local_name(name) is None:
        raise MeshError(
            "zip-names", "unsupported",
            f"The ZIP archive has a file with an unacceptable name: {_short(name)!r}.",
            "Names must be relative and stay inside the archive.",
        )  # fmt: skip
    if stat.S_ISLNK(entry.external_attr >> 16):
        raise _broken(f"{_short(name)!r} in the ZIP archive is a link.")
    if entry.flag_bits & ENCRYPTED_FLAG:
        raise MeshError(
            "zip-encrypted", "unsuitable", "The ZIP archive is encrypted.", "Save it without a password."
        )
    if entry.file_size > MAX_BYTES:
        raise _too_large()
    if entry.file_size > max(SMALL_BYTES, MAX_RATIO * entry.compress_size):
        raise MeshError(
            "zip-ratio", "too-large",
            f"{_short(name)!r} in the ZIP archive expands more than {MAX_RATIO} times.", ARCHIVE_HINT,
        )  # fmt: skip


def _of(names: list[str], suffixes: tuple[str, ...]) -> list[str]:
    return [name for name in names if _suffix(name) in suffixes]


def _suffix(name: str) -> str:
    return posixpath.splitext(name.lower())[1]


def _is_hidden(name: str) -> bool:
    return name.lower().startswith(HIDDEN_PREFIXES) or posixpath.basename(name).startswith(
        ("._", ".DS_Store")
    )


def _no_model(names: list[str]) -> MeshError:
    other = _of(names, UNREADABLE_SUFFIXES)
    inner = _of(names, ARCHIVES)
    if other:
        title = f"The ZIP archive contains {_short(other[0])!r}, which cannot be read."
        return MeshError(
            "unsupported-type", "unsupported", title, "Export it as GLB (in Blender: glTF Binary)."
        )
    if inner:
        title = f"The ZIP archive contains only another archive, {_short(inner[0])!r}."
        return MeshError("nested-archive", "unsupported", title, "Unpack it and upload the archive inside.")
    return MeshError("unsupported-type", "unsupported", "The ZIP archive contains no model.", ARCHIVE_HINT)


def _several(models: list[str]) -> MeshError:
    listed = ", ".join(_short(name) for name in models[:12]) + (", …" if len(models) > 12 else "")
    return MeshError(
        "several-models", "unsuitable", f"The ZIP archive contains {len(models)} models: {listed}.",
        "Upload one of them, or an archive with one of them and its textures.",
    )  # fmt: skip


def _too_large() -> MeshError:
    return MeshError(
        "zip-size", "too-large",
        f"The files of the ZIP archive are larger than {MAX_BYTES >> 20} MB when unpacked.",
        "Reduce the textures and the number of faces.",
    )  # fmt: skip


def _broken(title: str) -> MeshError:
    return MeshError("unreadable", "malformed", title, "The archive is damaged; create it again.")


def _short(name: str) -> str:
    return name[:80]
