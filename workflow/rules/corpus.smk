# Tables over all models.


# results/corpus/models.parquet, models.csv: one row per mesh, accepted or not. The figures
# are those of the models' own files, for which the status tables stand.
rule collect_models:
    input:
        **status_tables(),
    output:
        table=report("results/corpus/models.parquet", caption="../report/table.rst", category="All models"),
        text="results/corpus/models.csv",
    log:
        "results/logs/collect_models.log",
    resources:
        mem_mb=gathering_memory,
        runtime=gathering_runtime,
    params:
        code=CODE["collect_models"],
    run:
        run_job("collect_models", input, output, params, log)


# results/corpus/distances.parquet, neighbours.parquet: how like each other the models are.
rule compare_shapes:
    input:
        status=COMPARED,
    output:
        tables=[str(path) for path in LIKENESS_TABLES],
    log:
        "results/logs/compare_shapes.log",
    resources:
        mem_mb=comparing_memory,
        runtime=gathering_runtime,
    params:
        options={key: config["similarity"][key] for key in ("by", "manifold", "neighbours")},
        code=CODE["compare_shapes"],
    run:
        run_job("compare_shapes", input, output, params, log)


# results/corpus/report.html: the same as a page, what needs a look first. It links to what the stages left of each
# model, for which the table of models stands.
rule report_models:
    input:
        table="results/corpus/models.parquet",
        likeness=LIKENESS,
        carried=carried_files,
    output:
        page=report("results/corpus/report.html", caption="../report/models.rst", category="All models"),
    log:
        "results/logs/report_models.log",
    resources:
        mem_mb=gathering_memory,
        runtime=gathering_runtime,
    params:
        config={key: value for key, value in config.items() if key not in UNTOLD},
        own=len(OWN),
        stages=CHOSEN,
        code=CODE["report_models"],
    run:
        run_job("report_models", input, output, params, log)
