from .analyses.analysis_files import PLOT_FILE as PLOT_FILE
from .processes import start_module as start_module
from .queue import add_job as add_job
from .queue import find_job as find_job
from .queue import queue_job as queue_job
from .queue import request_cancel as request_cancel
from .supervisor import Supervisor as Supervisor
from .table_fingerprint import fingerprint as fingerprint
