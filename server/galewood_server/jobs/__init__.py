"""The job queue: jobs run in child processes and store their results. Only this package uses Dask."""

from typing import TYPE_CHECKING

from galewood.util import lazily

from galewood_server.jobs.analysis_files import PLOT_FILE
from galewood_server.jobs.queue import add_job, find_job, queue_job, request_cancel
from galewood_server.jobs.table_fingerprint import fingerprint

if TYPE_CHECKING:
    from galewood_server.jobs.processes import start_module
    from galewood_server.jobs.supervisor import Supervisor

# job processes import this package too and have no use for what the supervisor loads
__getattr__ = lazily(
    __name__,
    {
        "Supervisor": "galewood_server.jobs.supervisor",
        "start_module": "galewood_server.jobs.processes",
    },
)
__all__ = [
    "PLOT_FILE",
    "Supervisor",
    "add_job",
    "find_job",
    "fingerprint",
    "queue_job",
    "request_cancel",
    "start_module",
]
