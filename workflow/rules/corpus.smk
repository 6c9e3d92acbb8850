# Tables over all models.


# results/corpus/models.parquet, models.csv: one row per mesh, accepted or not. The figures
# are those of the models' own files, for which the status tables stand.
rule collect_models:
    input:
        **status_tables(),
    output:
        table="results/corpus/models.parquet",
        text="results/corpus/models.csv",
    log:
        "results/logs/collect_models.log",
    benchmark:
        "results/benchmarks/collect_models.tsv"
    resources:
        mem_mb=gathering_memory,
        runtime=gathering_runtime,
    params:
        code=CODE["collect_models"],
    script:
        "../scripts/collect_models.py"
