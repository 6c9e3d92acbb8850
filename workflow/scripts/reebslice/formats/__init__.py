"""File formats: the only place of the library that opens files."""
