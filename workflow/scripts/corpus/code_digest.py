"""What the code of a stage is: the files that it is made of, their digest, what they declare."""

import ast
import hashlib
import os
from functools import cache
from pathlib import Path


def digest_code(script):
    """Return a digest of a script and of every module beside it that it imports, directly or not."""
    digest = hashlib.blake2b(digest_size=16)
    for path in find_sources(script):
        digest.update(path.relative_to(Path(script).parent).as_posix().encode() + b"\0")
        digest.update(path.read_bytes() + b"\0")
    return digest.hexdigest()


def find_sources(script):
    """Return the sorted paths of a script, of modules in its folder that it imports, transitively, and of their files.

    A file of a module lies beside it and is named in it: a template, or what else it reads of its own.
    """
    root = Path(script).parent
    found, waiting = set(), [Path(script)]
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            package = path.relative_to(root).parent.parts
            waiting += [source for module in _imports(path.read_bytes(), package) for source in _locate(module, root)]
    return sorted(found.union(*(_named_files(path) for path in found)))


def _named_files(path):
    """Return the paths of the files beside a module, no modules themselves, that its source names in quotes."""
    text = path.read_bytes()
    beside = (file for file in path.parent.iterdir() if file.suffix != ".py")
    return [file for file in beside if b'"%s"' % file.name.encode() in text and file.is_file()]


@cache  # stages share most of their modules
def _imports(text, package):
    """Return the dotted names, from the root, of all that the source `text` of a module in `package` may import."""
    names = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names.update(tuple(alias.name.split(".")) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) + 1 - node.level] if node.level else ()
            base += tuple((node.module or "").split(".")) if node.module else ()
            names.update((base, *(base + (alias.name,) for alias in node.names)))
    return names


def _locate(module, root):
    """Yield the source files that importing the dotted name runs, packages above it included."""
    for length in range(1, len(module) + 1):
        place = root.joinpath(*module[:length])
        for path in (place.with_suffix(".py"), place / "__init__.py"):
            if path.is_file():
                yield path


def compiled_code_folder(library):
    """Return the absolute folder in which numba is to keep what it compiles of the library.

    Beside the library, or, where that is read-only, in the working directory.
    One folder per state of the library: numba itself does not notice that a
    compiled function calls one, of another module, that has changed.
    """
    library = Path(library)
    digest = hashlib.blake2b(digest_size=8)
    for path in sorted(library.glob("**/*.py")):
        digest.update(path.read_bytes())
    beside = library / "__pycache__"
    writable = os.access(beside if beside.is_dir() else library, os.W_OK)
    return ((beside if writable else Path(".snakemake")) / f"numba-{digest.hexdigest()}").absolute()


def read_outputs(script):
    """Return the constant OUTPUTS of a stage script, the names of the files that it writes per model."""
    for node in ast.parse(Path(script).read_bytes(), str(script)).body:
        if isinstance(node, ast.Assign) and any(getattr(name, "id", "") == "OUTPUTS" for name in node.targets):
            return tuple(ast.literal_eval(node.value))
    raise ValueError(f"{script}: a stage script declares OUTPUTS, the names of the files that it writes")
