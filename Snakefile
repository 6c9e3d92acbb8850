"""reebslice, for `snakemake` in the checkout; the map is workflow/Snakefile."""


include: "workflow/Snakefile"


workflow.default_target = "all"  # which Snakemake does not take from a file that is included
