"""Access control: keys, origins, rate and connection limits, quotas, limits on mesh import."""

from galewood_server.access.face_count import check_face_count
from galewood_server.access.import_limits import MeshImporter, limited_importer
from galewood_server.access.keys import HARMLESS, UNSAFE, new_key
from galewood_server.access.middleware import AccessControl
from galewood_server.access.origins import origin_allowed
from galewood_server.access.quota import need_room, note_stored, stored_bytes

__all__ = [
    "HARMLESS",
    "UNSAFE",
    "AccessControl",
    "MeshImporter",
    "check_face_count",
    "limited_importer",
    "need_room",
    "new_key",
    "note_stored",
    "origin_allowed",
    "stored_bytes",
]
