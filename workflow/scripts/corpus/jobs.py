"""Jobs as forks of one process that has loaded what they need.

A job on small models takes some hundredths of a second, and loading numba,
scipy and the rest a hundred times that. So a run loads them once: a fork
server, a process of its own, imports the modules of the stages, and every job is
a fork of it. It is started by the first job and ends with the process that started
it. (That of `multiprocessing` would run the main module, Snakemake's, in every fork.)
"""

import atexit
import gc
import os
import signal
import socket
import subprocess
import sys
import threading
from contextlib import suppress
from importlib import import_module
from multiprocessing.connection import Connection
from types import SimpleNamespace
from typing import NamedTuple

from .process import die_with, print_into

# Jobs use one core each, which libraries do not know; and a process with threads is not safely forked.
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS"), "1")
START = (
    "import sys; sys.path.insert(0, sys.argv[1]); from corpus.jobs import serve; serve(int(sys.argv[2]), sys.argv[3:])"
)


PATIENCE = 10  # seconds that the fork server may take to end


class JobError(Exception):
    """A job came to no good end; its log says why."""


class Job(NamedTuple):
    """What a job is told by its rule.

    `limits`, those of a model, are no parameter of the rule: others are no
    reason to run what has been done within these.
    """

    input: SimpleNamespace
    output: SimpleNamespace
    params: SimpleNamespace
    log: str
    limits: dict

    @classmethod
    def describe(cls, input, output, params, log, limits):
        """Return the job of what Snakemake gives a rule: lists with names, of which it makes plain ones."""
        return cls(_plain(input), _plain(output), _plain(params), str(log), limits)


def _plain(names):
    """A namespace of what a list of Snakemake's has names for; lists in it become plain ones."""
    return SimpleNamespace(**{name: list(each) if isinstance(each, list) else each for name, each in names.items()})


class ForkServer:
    """Runs jobs, each in a process of its own in which the modules of stages are loaded.

    Parameters
    ----------
    scripts : path
        The folder of the modules.
    modules : list of str
        Modules that jobs are likely to need; others are loaded by the job that needs them.
    """

    def __init__(self, scripts, modules=()):
        self.scripts, self.modules = str(scripts), list(modules)
        self._lock, self._process, self._control = threading.Lock(), None, None

    def run(self, name, job):
        """Run one job to its end; several threads may do so at once.

        Parameters
        ----------
        name : str
            The module that does the work: a stage (:func:`.stages.run_batch`), or one with ``gather(job)``.
        job : Job

        Raises
        ------
        JobError
        """
        here, there = socket.socketpair()
        with there:
            self._hand_over(there)
        with Connection(here.detach()) as pipe:
            try:
                pipe.send((name, job))
                pipe.recv()
            except (EOFError, OSError):
                raise JobError(f"{name} came to no good end{self._say_end()}; its log is {job.log}") from None

    def _say_end(self):
        """Say that the fork server has ended, if so."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(0.2)  # which the end of a job may come a little before
            return ", as the process ended of which all jobs are forks; another takes its place, so start the run again"
        return ""

    def _hand_over(self, end):
        """Have the server fork a process that talks through this socket; start it if it is not there, or no more."""
        with self._lock:
            if self._process is None or self._process.poll() is not None:
                self._start()
            socket.send_fds(self._control, [b"j"], [end.fileno()])

    def _start(self):
        self._control, far = socket.socketpair()
        command = [sys.executable, "-P", "-c", START, self.scripts, str(far.fileno()), *self.modules]
        with far:
            environment = os.environ | ONE_THREAD
            self._process = subprocess.Popen(command, pass_fds=[far.fileno()], env=environment)  # noqa: S603, this Python
        atexit.register(self._close, self._control, self._process)

    @staticmethod
    def _close(control, process):
        """End a fork server, with what it forked, and wait until it has ended."""
        control.close()
        with suppress(subprocess.TimeoutExpired):
            process.wait(PATIENCE)
        process.kill()
        process.wait()


def wait_in_threads(workflow):
    """Have threads wait for the jobs of a run, not each another Snakemake, as --force-use-threads does.

    Parameters
    ----------
    workflow : snakemake.workflow.Workflow
    """
    execute = workflow.execute

    def execute_with_threads(*arguments, **settings):
        workflow.execution_settings.use_threads = True  # which are not known before
        execute(*arguments, **settings)

    workflow.execute = execute_with_threads


def serve(number, modules):
    """Be the fork server: load the modules, then fork for every socket that comes through that of this file number.

    Ends when the other end is closed, which the system does for a process that is killed, too.
    """
    interrupted = signal.signal(signal.SIGINT, signal.SIG_IGN)  # a user's Ctrl-C is for the jobs, unless ignored
    control, server = socket.socket(fileno=number), os.getpid()
    with suppress(Exception):  # the job that needs it says what is wrong
        for name in modules:
            import_module(name)
        if "reebslice.kernels" in sys.modules:
            sys.modules["reebslice.kernels"].do_nothing()
    gc.freeze()
    while True:
        message, ends, *_ = socket.recv_fds(control, 1, 1)
        if not message:
            return
        if os.fork() == 0:
            signal.signal(signal.SIGINT, interrupted)
            control.close()
            die_with(server)
            _work(Connection(ends[0]))
        os.close(ends[0])
        with suppress(ChildProcessError):
            while os.waitpid(-1, os.WNOHANG)[0]:  # forget those that ended
                pass


def _work(pipe):
    """Do the one job that comes through the pipe, say so when it is done, and end this process."""
    from .stages import run_batch  # which the process that only runs jobs has no need of

    log = os.devnull
    try:
        name, job = pipe.recv()
        log = job.log
        print_into(log)
        module = import_module(name)
        if hasattr(module, "OUTPUTS"):
            run_batch(job, module.main, module.OUTPUTS)
        else:
            module.gather(job)
        sys.stdout.flush()
        pipe.send("done")
    except BaseException:
        sys.excepthook(*sys.exc_info())
    finally:
        os._exit(0)
