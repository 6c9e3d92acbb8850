"""What all tests share: where compiled code is kept."""

import os
from pathlib import Path

from corpus.code_digest import compiled_code_folder

# Before any test imports numba, which reads it once.
LIBRARY = Path(__file__).parent.parent / "workflow" / "scripts" / "reebslice"
os.environ.setdefault("NUMBA_CACHE_DIR", str(compiled_code_folder(LIBRARY)))
