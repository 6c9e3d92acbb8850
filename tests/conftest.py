"""What all tests share: where compiled code is kept, and that no test is about seconds."""

import os
from pathlib import Path

from hypothesis import settings

from corpus.code_digest import compiled_code_folder

# Before any test imports numba, which reads it once.
LIBRARY = Path(__file__).parent.parent / "workflow" / "scripts" / "reebslice"
os.environ.setdefault("NUMBA_CACHE_DIR", str(compiled_code_folder(LIBRARY)))

# An example may be the first that calls a kernel, which is compiled then.
settings.register_profile("unhurried", deadline=None)
settings.load_profile("unhurried")
