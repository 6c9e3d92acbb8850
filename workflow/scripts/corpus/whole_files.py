"""Files that appear whole or not at all, what it takes to see them on the disk, and their digests."""

import ctypes
import hashlib
import os
from contextlib import contextmanager
from pathlib import Path

_LIBC = ctypes.CDLL(None, use_errno=True)


@contextmanager
def place_whole(path, durably=False):
    """Give a scratch path in the folder of `path`; rename it there on success, and `durably` see it on the disk."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    scratch = path.with_name(f".writing-{os.getpid()}-{path.name}"[:200])
    try:
        yield scratch
        if durably:
            _see_on_disk(scratch)
        os.replace(scratch, path)
        if durably:
            _see_on_disk(path.parent)
    finally:
        scratch.unlink(missing_ok=True)


def remove_remains(folder, name="*"):
    """Remove from a folder what writers of files of this name left there when they were killed."""
    for left in Path(folder).glob(f".writing-*-{name}"):
        left.unlink(missing_ok=True)


def _see_on_disk(path):
    """Wait until a file, or what names a folder holds, is on the disk."""
    with _opened(path) as place:
        os.fsync(place)


def sync(folder):
    """Wait until all that was written on the file system of a folder is on the disk.

    One call for many files: a disk takes about as long for one as for all.
    """
    with _opened(folder) as place:
        _sync_file_system(place)


def _sync_file_system(place):
    if not hasattr(_LIBC, "syncfs"):  # as on macOS
        os.sync()
    elif _LIBC.syncfs(place):
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


@contextmanager
def _opened(path):
    place = os.open(path, os.O_RDONLY)
    try:
        yield place
    finally:
        os.close(place)


def digest_file(path):
    """Return a digest of the bytes of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=16)).hexdigest()
