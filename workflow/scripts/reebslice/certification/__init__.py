"""The proof that a model's graphs are right, by a recount.

Nothing here uses the code that made the tables: of the library only
:mod:`reebslice.schemas`, and on purpose other algorithms. :mod:`.recount`
finds everything anew from the mesh and the levels; :mod:`.checks` holds the files
against it and against theory; :mod:`.certificate` gives the verdict.
"""
