"""Compilation of kernels: numba's, kept on disk where a folder can be written."""

from functools import partial

import numba


def njit(function=None, **options):
    """Compile a function by `numba.njit`, keeping what is compiled for later processes.

    Where numba finds no folder that it can write to (neither beside the
    library nor in the user's cache nor in ``NUMBA_CACHE_DIR``), the function
    is compiled anew in every process, instead of failing to import.

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
        return numba.njit(cache=True, **options)(function)
    except RuntimeError:  # how numba says that no folder can be written
        return numba.njit(**options)(function)
