"""Gather the directions of all models into one table, and say which is the best of each."""

from corpus.gathering import gather_tables
from corpus.process import print_into
from corpus.storage import write_table


def main(tables):
    """Return the table `directions` over all accepted models, of the status tables of rate_directions."""
    return gather_tables(tables, "rate_directions", "directions")


if "snakemake" in globals():
    print_into(snakemake.log[0])
    table = main(list(snakemake.input))
    write_table(snakemake.output.table, "directions", table)
    frame = table.to_pandas()
    print(frame[frame["place"] == 0].drop(columns="place").round(3).to_string(index=False))
