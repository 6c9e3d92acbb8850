"""Gather the comparison of all models into one table and one figure."""

from corpus.gathering import gather_tables
from corpus.storage import write_table
from reebslice.drawing.charts import draw_comparison
from reebslice.links.comparison import EVERY, rates


def gather(job):
    """Write the table and the figure over the status tables `job.input.status`."""
    table = main(job.input.status)
    write_table(job.output.table, "comparison", table)
    draw_comparison(table).savefig(job.output.figure)
    frame = table.to_pandas()
    every = frame[frame["kind"] == EVERY]
    print(rates(every, ("half", "tilt", "n_levels", "method")).round(3).to_string())


def main(tables):
    """Return the table `comparison` over all accepted models, of the status tables of compare_links."""
    return gather_tables(tables, "compare_links", "comparison")
