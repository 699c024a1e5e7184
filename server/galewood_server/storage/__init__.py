"""The database and the content-addressed file stores."""

from galewood_server.storage.database import (
    Sessions,
    database_now,
    engine_of,
    migrate,
    migration_config,
    open_database,
)
from galewood_server.storage.encodings import PREFERRED, coding_of, encoded_file
from galewood_server.storage.files import KINDS, FileStore, Stores, file_age_s, is_hash
from galewood_server.storage.garbage import (
    ASKED,
    FIELDS,
    forget_old_studies,
    forget_study_folders,
    hold,
    referenced,
    retire,
    retire_replaced,
    retire_tree,
    sweep,
)
from galewood_server.storage.models import (
    ACTIVE,
    Job,
    JobKind,
    JobState,
    Retired,
    Tree,
    TreeState,
    new_id,
    utc_now,
)
from galewood_server.storage.table_cache import TableShelf

__all__ = [
    "ACTIVE",
    "ASKED",
    "FIELDS",
    "KINDS",
    "PREFERRED",
    "FileStore",
    "Job",
    "JobKind",
    "JobState",
    "Retired",
    "Sessions",
    "Stores",
    "TableShelf",
    "Tree",
    "TreeState",
    "coding_of",
    "database_now",
    "encoded_file",
    "engine_of",
    "file_age_s",
    "forget_old_studies",
    "forget_study_folders",
    "hold",
    "is_hash",
    "migrate",
    "migration_config",
    "new_id",
    "open_database",
    "referenced",
    "retire",
    "retire_replaced",
    "retire_tree",
    "sweep",
    "utc_now",
]
