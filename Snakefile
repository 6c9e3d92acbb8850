"""reebslice: from a folder of closed meshes to certified Reeb graphs.

This file is the map. The method is read in workflow/rules/stages.smk, one
rule per stage; the knobs are in config/config.yaml.
"""

from pathlib import Path

from snakemake.utils import min_version

min_version("9.0")


configfile: Path(workflow.basedir) / "config" / "config.yaml"


include: "workflow/rules/common.smk"
include: "workflow/rules/stages.smk"
include: "workflow/rules/corpus.smk"
include: "workflow/rules/compare.smk"


rule all:
    default_target: True
    input:
        "results/corpus/models.parquet",
        WITHDRAWN,


onstart:
    keep_going()
    drop_rate_limit()
    forget_forced()


onsuccess:
    close_run()


onerror:
    explain_error(log)
