# Tables over all models.


# results/corpus/models.parquet: one row per mesh, accepted or not.
rule collect_models:
    input:
        status=last_status_tables(),
    output:
        table="results/corpus/models.parquet",
    log:
        "results/logs/collect_models.log",
    benchmark:
        "results/benchmarks/collect_models.tsv"
    resources:
        mem_mb=1000,
    params:
        code=CODE["collect_models"],
    script:
        "../scripts/collect_models.py"
