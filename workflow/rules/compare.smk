# Not part of `rule all`, but asked for by name: how far links guessed from shapes alone are right,
# snakemake --cores 2 compare_methods; and which direction suits a model best, snakemake --cores 2 compare_directions


# Cuts the model at uniform levels, guesses links by each rule and counts what
# is missed and what is false, for every tilt and number of levels.
# Writes comparison.
rule compare_links:
    input:
        status="results/status/inspect_mesh/{batch}.parquet",
    output:
        status="results/status/compare_links/{batch}.parquet",
    log:
        "results/logs/compare_links/{batch}.log",
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options=config["compare"],
        code=CODE["compare_links"],
    run:
        run_job("compare_links", input, output, params, log)


# results/corpus/comparison.parquet and .png: all of them.
rule compare_methods:
    input:
        status=[f"results/status/compare_links/{batch}.parquet" for batch in BATCHES],
    output:
        table="results/corpus/comparison.parquet",
        figure="results/corpus/comparison.png",
    log:
        "results/logs/compare_methods.log",
    resources:
        mem_mb=gathering_memory,
        runtime=gathering_runtime,
    params:
        code=CODE["compare_methods"],
    run:
        run_job("compare_methods", input, output, params, log)


# What each of many directions of height would catch, hold, and leave in the air.
# Writes directions.
rule rate_directions:
    input:
        status="results/status/inspect_mesh/{batch}.parquet",
    output:
        status="results/status/rate_directions/{batch}.parquet",
    log:
        "results/logs/rate_directions/{batch}.log",
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options=config["directions"],
        code=CODE["rate_directions"],
    run:
        run_job("rate_directions", input, output, params, log)


# results/corpus/directions.parquet: all of them, of each model the best first.
rule compare_directions:
    input:
        status=[f"results/status/rate_directions/{batch}.parquet" for batch in BATCHES],
    output:
        table="results/corpus/directions.parquet",
    log:
        "results/logs/compare_directions.log",
    resources:
        mem_mb=gathering_memory,
        runtime=gathering_runtime,
    params:
        code=CODE["compare_directions"],
    run:
        run_job("compare_directions", input, output, params, log)
