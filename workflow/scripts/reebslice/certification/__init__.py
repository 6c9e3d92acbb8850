"""The proof that a model's graphs are right, by a recount.

Nothing here uses the code that made the tables: of the library only
:mod:`reebslice.schemas`, and on purpose other algorithms. The recount_*
modules find everything anew from the mesh and the levels; the others hold the
files against it and against theory; :mod:`.certificates` gives the verdict.
"""
