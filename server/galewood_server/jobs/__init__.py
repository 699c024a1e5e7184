"""The job queue: jobs in, child processes that compute, results published. Only this package uses Dask."""

from galewood_server.jobs.analysis_files import PLOT
from galewood_server.jobs.queue import add_job, find_job, queue_job, request_cancel
from galewood_server.jobs.supervisor import Supervisor
from galewood_server.jobs.table_fingerprint import fingerprint

__all__ = ["PLOT", "Supervisor", "add_job", "find_job", "fingerprint", "queue_job", "request_cancel"]
