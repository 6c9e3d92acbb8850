"""Gather what is known of every model into one table, as Parquet and as text.

One row per mesh of the corpus, accepted or not: how it ended and why, the
figures of its certificate and of its inspection, the seconds and the memory
of every stage.
"""

from pyarrow import csv

from corpus.layout import MODELS_TABLE, MODELS_TEXT
from corpus.model_table import make_model_table
from corpus.process import trim_startup
from corpus.receipts import seal_table
from corpus.storage import write_parquet
from corpus.whole_files import place_whole, remove_remains


def gather(job):
    """Write both tables over the status tables of all batches, `job.input` by stage."""
    trim_startup()
    remove_remains(MODELS_TABLE.parent)
    table = make_model_table(vars(job.input), job.params.code)
    write_parquet(MODELS_TABLE, table)
    with place_whole(MODELS_TEXT, durably=True) as scratch:
        csv.write_csv(table, scratch)
    seal_table(MODELS_TABLE, MODELS_TEXT)
