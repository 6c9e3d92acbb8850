"""Compilation of kernels: numba's, kept on disk where a folder can be written, and done by one process at a time."""

import zlib
from contextlib import contextmanager, suppress
from functools import cache, partial
from pathlib import Path

import numba
from numba.core.compiler_lock import global_compiler_lock

try:
    import fcntl
except ImportError:  # of systems other than Unix
    fcntl = None  # type: ignore[assignment]


def njit(function=None, **options):
    """Compile a function by `numba.njit`, keeping what is compiled for later processes.

    Of several processes that need a function which is not compiled yet, one
    compiles it, and the others wait and load it. Where numba finds no folder
    that it can write to (neither beside the library nor in the user's cache
    nor in ``NUMBA_CACHE_DIR``), the function is compiled anew in every
    process, instead of failing to import.

    Parameters
    ----------
    function : callable, optional
        The function; left out where options are given, as in ``@njit(inline="always")``.
    **options
        Options of `numba.njit` other than ``cache``.

    Returns
    -------
    callable
        numba's dispatcher, or a decorator where no function was given.
    """
    if function is None:
        return partial(njit, **options)
    try:
        dispatcher = numba.njit(cache=True, **options)(function)
    except RuntimeError:  # how numba says that no folder can be written
        return numba.njit(**options)(function)
    if fcntl and hasattr(dispatcher, "_cache"):  # a plain function where numba is switched off
        dispatcher.compile = _compile_alone(dispatcher.compile, dispatcher._cache.cache_path, function.__qualname__)
    return dispatcher


def _compile_alone(compile_now, folder, name):
    """The function that compiles, holding a lock meanwhile that other processes wait for."""

    def compile_alone(signature):
        # A process's own threads are kept apart first, as locks of a file do not tell them apart.
        with global_compiler_lock, _lock(folder, zlib.crc32(name.encode())):
            return compile_now(signature)

    return compile_alone


@contextmanager
def _lock(folder, place):
    """Hold one byte of the lock file of a folder; nothing, where it cannot be had.

    A function waits only for those that it calls, so no two processes wait for each other; where names share
    a byte and they do, the system says so to one of them.
    """
    file, held = None, False
    with suppress(OSError):
        file = _open_lock(folder)
        fcntl.lockf(file, fcntl.LOCK_EX, 1, place)
        held = True
    try:
        yield
    finally:
        if held:
            fcntl.lockf(file, fcntl.LOCK_UN, 1, place)


@cache  # closing any of several would unlock all
def _open_lock(folder):
    """The lock file of a folder, open for writing as long as the process lives."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    return open(Path(folder, "compiling.lock"), "wb")


@njit
def do_nothing():
    """Do nothing; the first call has numba load what every other needs, half a second's worth."""
