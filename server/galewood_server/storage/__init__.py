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
from galewood_server.storage.files import STORE_NAMES, FileStore, Stores, file_age_s, is_hash
from galewood_server.storage.garbage import (
    ANALYSIS_INPUTS,
    HASH_COLUMNS,
    collect_garbage,
    forget_analysis_folders,
    forget_old_analyses,
    mark_garbage,
    mark_replaced,
    mark_tree_files,
    referenced_files,
    store_referenced,
)
from galewood_server.storage.models import (
    ACTIVE,
    Garbage,
    Job,
    JobKind,
    JobState,
    Tree,
    TreeState,
    new_id,
    utc_now,
)
from galewood_server.storage.table_cache import TableCache

__all__ = [
    "ACTIVE",
    "ANALYSIS_INPUTS",
    "HASH_COLUMNS",
    "PREFERRED",
    "STORE_NAMES",
    "FileStore",
    "Garbage",
    "Job",
    "JobKind",
    "JobState",
    "Sessions",
    "Stores",
    "TableCache",
    "Tree",
    "TreeState",
    "coding_of",
    "collect_garbage",
    "database_now",
    "encoded_file",
    "engine_of",
    "file_age_s",
    "forget_analysis_folders",
    "forget_old_analyses",
    "is_hash",
    "mark_garbage",
    "mark_replaced",
    "mark_tree_files",
    "migrate",
    "migration_config",
    "new_id",
    "open_database",
    "referenced_files",
    "store_referenced",
    "utc_now",
]
