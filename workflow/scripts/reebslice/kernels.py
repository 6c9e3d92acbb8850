"""Compilation of kernels: numba's, kept on disk where a folder can be written, and done by one process at a time."""

import gc
import zlib
from contextlib import contextmanager, suppress
from functools import cache, partial
from pathlib import Path

import numba
from numba import types
from numba.core.compiler_lock import global_compiler_lock

try:
    import fcntl
except ImportError:  # of systems other than Unix
    fcntl = None  # type: ignore[assignment]


def njit(function=None, inner=False, **options):
    """Compile a function by `numba.njit`, keeping what is compiled for later processes.

    Of several processes that need a function which is not compiled yet, one
    compiles it, and the others wait and load it. Where numba finds no folder
    that it can write to (neither beside the library nor in the user's cache
    nor in ``NUMBA_CACHE_DIR``), the function is compiled anew in every
    process, instead of failing to import.

    Compiling costs some tenths of a second for each combination of types of
    arguments, so a constant that a kernel hands to another makes no
    combination of its own. Nor does a kernel get a wrapper for callers in C.

    Parameters
    ----------
    function : callable, optional
        The function; left out where options are given, as in ``@njit(inline="always")``.
    inner : bool
        Whether only kernels call it: it gets no wrapper for Python then, which takes a sixth of the time of
        compiling it, and Python can call it no more.
    **options
        Options of `numba.njit` other than ``cache`` and ``no_cfunc_wrapper``.

    Returns
    -------
    callable
        numba's dispatcher, or a decorator where no function was given.
    """
    if function is None:
        return partial(njit, inner=inner, **options)
    options |= {"no_cfunc_wrapper": True, "no_cpython_wrapper": inner}
    try:
        dispatcher = numba.njit(cache=True, **options)(function)
    except RuntimeError:  # how numba says that no folder can be written
        dispatcher = numba.njit(**options)(function)
    if hasattr(dispatcher, "_cache"):  # a plain function where numba is switched off
        dispatcher.compile = _compile_alone(dispatcher.compile, dispatcher._cache.cache_path, function.__qualname__)
        dispatcher.get_call_template = _take_constants(dispatcher.get_call_template)
        if inner:
            _close_to_python(dispatcher)
    return dispatcher


def _close_to_python(dispatcher):
    """Have Python raise TypeError where it calls this kernel, instead of jumping to a wrapper that is not there."""

    def refuse(*_, **__):
        raise TypeError(f"{dispatcher.py_func.__qualname__} is for kernels to call; declare it without `inner`")

    def keep(compiled):
        dispatcher.overloads[tuple(compiled.signature.args)] = compiled

    dispatcher._compile_for_args, dispatcher.add_overload = refuse, keep


def _compile_alone(compile_now, folder, name):
    """The function that compiles, holding a lock meanwhile that other processes wait for.

    Garbage is not looked for, as the many objects of the compiler would be looked through time and again; that
    takes a fifth of the time.
    """

    def compile_alone(signature):
        # A process's own threads are kept apart first, as locks of a file do not tell them apart.
        with global_compiler_lock, _leave_garbage(), _lock(folder, zlib.crc32(name.encode())):
            return compile_now(signature)

    return compile_alone


def _take_constants(find_template):
    """The function that finds what another kernel calls, by the types of its arguments, constants like any others."""

    def find_for_any(arguments, names):
        values = {name: types.unliteral(kind) for name, kind in names.items()}
        return find_template(tuple(map(types.unliteral, arguments)), values)

    return find_for_any


@contextmanager
def _leave_garbage():
    """Keep Python from looking for garbage."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


@contextmanager
def _lock(folder, place):
    """Hold one byte of the lock file of a folder; nothing, where there is no folder (None) or it cannot be had.

    A function waits only for those that it calls, so no two processes wait for each other; where names share
    a byte and they do, the system says so to one of them.
    """
    file, held = None, False
    with suppress(OSError):
        if folder and fcntl:
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
