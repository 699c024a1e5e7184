"""The database and the content-addressed file stores."""

from galewood_server.storage.database import (
    Sessions,
    database_now,
    engine_of,
    migrate,
    migration_config,
    open_database,
)
from galewood_server.storage.encodings import PREFERRED, coding_of, encoded_file, preferred_coding
from galewood_server.storage.files import FileStore, file_age_s, is_hash
from galewood_server.storage.garbage import (
    ANALYSIS_INPUTS,
    FILE_COLUMNS,
    collect_garbage,
    forget_analysis_folders,
    forget_old_analyses,
    mark_garbage,
    mark_tree_files,
    no_table,
    referenced_files,
    replace_files,
    store_referenced,
)
from galewood_server.storage.models import (
    ACTIVE,
    Form,
    Garbage,
    Job,
    JobKind,
    JobState,
    SharedForest,
    Tree,
    TreeState,
    new_id,
    utc_now,
)
from galewood_server.storage.object_store import fetch, list_keys, open_bucket, stored
from galewood_server.storage.records import compliance_of, records_of
from galewood_server.storage.stores import STORE_NAMES, Stores
from galewood_server.storage.table_cache import TableCache

__all__ = [
    "ACTIVE",
    "ANALYSIS_INPUTS",
    "FILE_COLUMNS",
    "PREFERRED",
    "STORE_NAMES",
    "FileStore",
    "Form",
    "Garbage",
    "Job",
    "JobKind",
    "JobState",
    "Sessions",
    "SharedForest",
    "Stores",
    "TableCache",
    "Tree",
    "TreeState",
    "coding_of",
    "collect_garbage",
    "compliance_of",
    "database_now",
    "encoded_file",
    "engine_of",
    "fetch",
    "file_age_s",
    "forget_analysis_folders",
    "forget_old_analyses",
    "is_hash",
    "list_keys",
    "mark_garbage",
    "mark_tree_files",
    "migrate",
    "migration_config",
    "new_id",
    "no_table",
    "open_bucket",
    "open_database",
    "preferred_coding",
    "records_of",
    "referenced_files",
    "replace_files",
    "store_referenced",
    "stored",
    "utc_now",
]
