"""Gather the directions of all models into one table, and say which is the best of each."""

from corpus.gathering import gather_tables
from corpus.storage import write_table


def gather(job):
    """Write the table over the status tables `job.input.status`."""
    table = main(job.input.status)
    write_table(job.output.table, "directions", table)
    frame = table.to_pandas()
    print(frame[frame["place"] == 0].drop(columns="place").round(3).to_string(index=False))


def main(tables):
    """Return the table `directions` over all accepted models, of the status tables of rate_directions."""
    return gather_tables(tables, "rate_directions", "directions")
