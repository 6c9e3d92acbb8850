"""What the code of a stage is: the files that it is made of, their digest, what they declare."""

import ast
import hashlib
import os
from functools import cache
from pathlib import Path


def digest_code(script, *more):
    """Return a digest of scripts and of every module beside the first that they import, directly or not."""
    digest = hashlib.blake2b(digest_size=16)
    for path in find_sources(script, *more):
        digest.update(path.relative_to(Path(script).parent).as_posix().encode() + b"\0")
        digest.update(path.read_bytes() + b"\0")
    return digest.hexdigest()


def find_sources(script, *more):
    """Return the sorted paths of scripts, of modules in the first one's folder that they import, and of their files.

    A file of a module lies beside it and is named in it: a template, or what else it reads of its own.
    """
    root = Path(script).parent
    found, waiting = set(), [str(path) for path in (script, *more)]
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            if path.endswith(".py"):
                with open(path, "rb") as file:
                    waiting += _direct_sources(file.read(), path, str(root))
    return sorted(map(Path, found))


@cache  # stages share most of their modules
def _direct_sources(text, path, root):
    """Return the paths of the files that the module at `path`, whose source is `text`, imports or names."""
    folder = os.path.dirname(path)
    package = tuple(Path(folder).relative_to(root).parts)
    found = [source for module in _imports(text, package) for source in _locate(module, root)]
    for file in os.scandir(folder):
        if not file.name.endswith(".py") and b'"%s"' % file.name.encode() in text and file.is_file():
            found.append(file.path)
    return found


def _imports(text, package):
    """Return the dotted names, from the root, of all that the source `text` of a module in `package` may import."""
    names, waiting = set(), ast.parse(text).body
    while waiting:  # statements only, of which expressions hold none
        node = waiting.pop()
        if isinstance(node, ast.Import):
            names.update(tuple(alias.name.split(".")) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) + 1 - node.level] if node.level else ()
            base += tuple((node.module or "").split(".")) if node.module else ()
            names.update((base, *(base + (alias.name,) for alias in node.names)))
        for block in ("body", "orelse", "handlers", "finalbody", "cases"):
            waiting += getattr(node, block, ())
    return names


def _locate(module, root):
    """Return the source files that importing the dotted name runs, packages above it included."""
    paths = [os.path.join(root, *module[:length]) for length in range(1, len(module) + 1)]
    return [
        path for place in paths for path in (f"{place}.py", os.path.join(place, "__init__.py")) if os.path.isfile(path)
    ]


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
