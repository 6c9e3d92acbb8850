"""Running stages over the models of a corpus."""

import sys
from pathlib import Path

# What is beside this package comes first: of an installed library, which a stage would meet before, no receipt tells.
sys.path.insert(0, str(Path(__file__).parents[1]))
