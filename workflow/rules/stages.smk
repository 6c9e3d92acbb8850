# The method, stage by stage. A job runs one stage over one batch of models: it
# reads and writes the files in results/models/{model}/ and leaves the status
# table of the batch, which says of each model: ok, rejected, failed or skipped.
# A model whose inputs, options and code are those of last time is passed over.
# Options go to the stages that use them, so a changed key reaches those and the
# ones behind, and no other; so do those of single models, from the sheet.

# From where all pictures are seen.
VIEW = {key: config["draw"][key] for key in ("width", "azimuth", "elevation")}


# Reads the mesh, makes it a closed oriented surface or rejects it with a reason.
# Writes inspection.json and the surface: vertices, faces, shells.
rule inspect_mesh:
    input:
        meshes=inputs_of,
    output:
        status="results/status/inspect_mesh/{batch}.parquet",
    log:
        "results/logs/inspect_mesh/{batch}.log",
    priority: priority_at("inspect_mesh")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        models=models_of,
        paths=paths_of,
        stamp=stamp_of,
        options=config["inspect"],
        own=own_options(lambda config: config["inspect"]),
        code=CODE["inspect_mesh"],
    run:
        run_job("inspect_mesh", input, output, params, log)


# Chooses the direction of height, so that the height is a Morse function.
# Writes tilt.json.
rule select_tilt:
    input:
        status="results/status/inspect_mesh/{batch}.parquet",
    output:
        status="results/status/select_tilt/{batch}.parquet",
    log:
        "results/logs/select_tilt/{batch}.log",
    priority: priority_at("select_tilt")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options=config["tilt"],
        own=own_options(lambda config: config["tilt"]),
        code=CODE["select_tilt"],
    run:
        run_job("select_tilt", input, output, params, log)


# Cuts the surface at levels; finds contours, and the pieces between levels.
# Writes levels, contours, pieces.
rule slice_mesh:
    input:
        status="results/status/select_tilt/{batch}.parquet",
    output:
        status="results/status/slice_mesh/{batch}.parquet",
    log:
        "results/logs/slice_mesh/{batch}.log",
    priority: priority_at("slice_mesh")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options=config["levels"],
        own=own_options(lambda config: config["levels"]),
        code=CODE["slice_mesh"],
    run:
        run_job("slice_mesh", input, output, params, log)


# Finds the Morse event in every piece that has one, and its handle operation.
# Writes handles; the exact Reeb graph of the surface, critical_points and critical_arcs; and
# in sampling.json how densely levels must lie to show all of it.
rule classify_handles:
    input:
        status="results/status/slice_mesh/{batch}.parquet",
    output:
        status="results/status/classify_handles/{batch}.parquet",
    log:
        "results/logs/classify_handles/{batch}.log",
    priority: priority_at("classify_handles")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options={},
        code=CODE["classify_handles"],
    run:
        run_job("classify_handles", input, output, params, log)


# Puts one material point into every region of every level.
# Writes nodes.
rule sample_nodes:
    input:
        status="results/status/classify_handles/{batch}.parquet",
    output:
        status="results/status/sample_nodes/{batch}.parquet",
    log:
        "results/logs/sample_nodes/{batch}.log",
    priority: priority_at("sample_nodes")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options=config["nodes"],
        code=CODE["sample_nodes"],
    run:
        run_job("sample_nodes", input, output, params, log)


# Links the material points of consecutive levels into both Reeb graphs.
# Writes edges, arcs, and the graphs solid, surface and augmented, the first two simplified as well.
rule synthesize_edges:
    input:
        status="results/status/sample_nodes/{batch}.parquet",
    output:
        status="results/status/synthesize_edges/{batch}.parquet",
    log:
        "results/logs/synthesize_edges/{batch}.log",
    priority: priority_at("synthesize_edges")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options=config["edges"] | {"levels": config["levels"]},
        own=own_options(lambda config: config["edges"] | {"levels": config["levels"]}),
        code=CODE["synthesize_edges"],
    run:
        run_job("synthesize_edges", input, output, params, log)


# Recomputes every invariant from the files and the mesh, and gives the verdict.
# Writes certificate.json.
rule certify:
    input:
        status="results/status/synthesize_edges/{batch}.parquet",
    output:
        status="results/status/certify/{batch}.parquet",
    log:
        "results/logs/certify/{batch}.log",
    priority: priority_at("certify")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options=config["levels"],
        own=own_options(lambda config: config["levels"]),
        code=CODE["certify"],
    run:
        run_job("certify", input, output, params, log)


# Draws every model as in the paper, each figure as SVG and PDF.
rule draw_figures:
    input:
        status="results/status/certify/{batch}.parquet",
    output:
        status="results/status/draw_figures/{batch}.parquet",
    log:
        "results/logs/draw_figures/{batch}.log",
    priority: priority_at("draw_figures")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options=VIEW | {"graph": config["draw"]["graph"]},
        code=CODE["draw_figures"],
    run:
        run_job("draw_figures", input, output, params, log)


# Finds where liquid stays, where air is caught, and what begins in the air, in the direction of height.
# Writes pockets and islands; aside of the stages above, which do not wait for it.
rule find_pockets:
    input:
        status="results/status/classify_handles/{batch}.parquet",
    output:
        status="results/status/find_pockets/{batch}.parquet",
    log:
        "results/logs/find_pockets/{batch}.log",
    priority: priority_at("find_pockets")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options={key: config["pockets"][key] for key in ("least_depth", "distance")},
        code=CODE["find_pockets"],
    run:
        run_job("find_pockets", input, output, params, log)


# Cuts pockets and islands out as closed bodies, and draws them. Writes pockets.glb and pockets.png.
rule cut_pockets:
    input:
        status="results/status/find_pockets/{batch}.parquet",
    output:
        status="results/status/cut_pockets/{batch}.parquet",
    log:
        "results/logs/cut_pockets/{batch}.log",
    priority: priority_at("cut_pockets")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options=VIEW,
        code=CODE["cut_pockets"],
    run:
        run_job("cut_pockets", input, output, params, log)


# Finds the place of every loop of the surface: a circle around it and a closed path along it.
# Writes loops; aside of the stages above, which do not wait for it.
rule find_loops:
    input:
        status="results/status/classify_handles/{batch}.parquet",
    output:
        status="results/status/find_loops/{batch}.parquet",
    log:
        "results/logs/find_loops/{batch}.log",
    priority: priority_at("find_loops")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options={"distance": config["loops"]["distance"]},
        code=CODE["find_loops"],
    run:
        run_job("find_loops", input, output, params, log)


# Draws the mesh with its loops.
rule draw_loops:
    input:
        status="results/status/find_loops/{batch}.parquet",
    output:
        status="results/status/draw_loops/{batch}.parquet",
    log:
        "results/logs/draw_loops/{batch}.log",
    priority: priority_at("draw_loops")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options=VIEW,
        code=CODE["draw_loops"],
    run:
        run_job("draw_loops", input, output, params, log)


# Finds the arcs on which each face lies, whole or cut where arcs end. Writes face_arcs; aside of the stages above.
rule label_faces:
    input:
        status="results/status/synthesize_edges/{batch}.parquet",
    output:
        status="results/status/label_faces/{batch}.parquet",
    log:
        "results/logs/label_faces/{batch}.log",
    priority: priority_at("label_faces")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options={"cut": config["faces"]["cut"], "method": config["edges"]["method"]},
        code=CODE["label_faces"],
    run:
        run_job("label_faces", input, output, params, log)


# Colours the surface by its arcs, cut where they end. Writes arcs.ply; aside of the stages above.
rule colour_faces:
    input:
        status="results/status/synthesize_edges/{batch}.parquet",
    output:
        status="results/status/colour_faces/{batch}.parquet",
    log:
        "results/logs/colour_faces/{batch}.log",
    priority: priority_at("colour_faces")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options={"by": config["colours"]["by"], "method": config["edges"]["method"]},
        code=CODE["colour_faces"],
    run:
        run_job("colour_faces", input, output, params, log)


# Takes the solid apart at its events into closed bodies, one per arc. Writes parts, as a table and as a scene.
rule decompose_solid:
    input:
        status="results/status/synthesize_edges/{batch}.parquet",
    output:
        status="results/status/decompose_solid/{batch}.parquet",
    log:
        "results/logs/decompose_solid/{batch}.log",
    priority: priority_at("decompose_solid")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options={"method": config["edges"]["method"]},
        code=CODE["decompose_solid"],
    run:
        run_job("decompose_solid", input, output, params, log)


# Writes the model for other programs: regions as polygons, poly data, SWC, arrays.
rule export_model:
    input:
        status="results/status/certify/{batch}.parquet",
    output:
        status="results/status/export_model/{batch}.parquet",
    log:
        "results/logs/export_model/{batch}.log",
    priority: priority_at("export_model")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options={"method": config["edges"]["method"]},
        code=CODE["export_model"],
    run:
        run_job("export_model", input, output, params, log)


# Builds the exact Reeb graphs of surface and solid without levels, of a mesh of any noise. Writes exact_nodes,
# exact_arcs, and both graphs as GraphML; instead of levels, or beside them.
rule build_graphs:
    input:
        status="results/status/select_tilt/{batch}.parquet",
    output:
        status="results/status/build_graphs/{batch}.parquet",
    log:
        "results/logs/build_graphs/{batch}.log",
    priority: priority_at("build_graphs")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options={},
        code=CODE["build_graphs"],
    run:
        run_job("build_graphs", input, output, params, log)


# Certifies these graphs by a sweep over the mesh. Writes exact_graphs.json.
rule certify_graphs:
    input:
        status="results/status/build_graphs/{batch}.parquet",
    output:
        status="results/status/certify_graphs/{batch}.parquet",
    log:
        "results/logs/certify_graphs/{batch}.log",
    priority: priority_at("certify_graphs")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options={},
        code=CODE["certify_graphs"],
    run:
        run_job("certify_graphs", input, output, params, log)


# Builds the Reeb graphs of other functions on the surface than the height, and certifies them. Writes function_values,
# function_nodes, function_arcs, functions.graphml and functions.json; aside of the stages above.
rule graph_functions:
    input:
        status="results/status/inspect_mesh/{batch}.parquet",
    output:
        status="results/status/graph_functions/{batch}.parquet",
    log:
        "results/logs/graph_functions/{batch}.log",
    priority: priority_at("graph_functions")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options={"functions": config["functions"]},
        own=own_values,
        code=CODE["graph_functions"],
    run:
        run_job("graph_functions", input, output, params, log)


# Describes the shape by numbers of its surface and of the graphs of its functions. Writes descriptors.
rule describe_shape:
    input:
        status="results/status/graph_functions/{batch}.parquet",
    output:
        status="results/status/describe_shape/{batch}.parquet",
    log:
        "results/logs/describe_shape/{batch}.log",
    priority: priority_at("describe_shape")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options={},
        code=CODE["describe_shape"],
    run:
        run_job("describe_shape", input, output, params, log)


# Traces the centrelines of tubes. Writes centreline_points, branches, and centrelines as poly data and SWC; aside of
# the stages above.
rule trace_centrelines:
    input:
        status="results/status/inspect_mesh/{batch}.parquet",
    output:
        status="results/status/trace_centrelines/{batch}.parquet",
    log:
        "results/logs/trace_centrelines/{batch}.log",
    priority: priority_at("trace_centrelines")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options={key: config["centrelines"][key] for key in ("distance", "prune")},
        code=CODE["trace_centrelines"],
    run:
        run_job("trace_centrelines", input, output, params, log)


# Draws the mesh with its graph inside, beside the graph by height.
rule draw:
    input:
        status="results/status/certify/{batch}.parquet",
    output:
        status="results/status/draw/{batch}.parquet",
    log:
        "results/logs/draw/{batch}.log",
    priority: priority_at("draw")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options=VIEW | {"graph": config["draw"]["graph"]},
        code=CODE["draw"],
    run:
        run_job("draw", input, output, params, log)


# Makes the page of every model, on which its surface, levels and graphs can be looked at.
# Writes view.html, and model.glb, of which it is made.
rule view:
    input:
        status="results/status/certify/{batch}.parquet",
    output:
        status="results/status/view/{batch}.parquet",
    log:
        "results/logs/view/{batch}.log",
    priority: priority_at("view")
    resources:
        mem_mb=memory_of,
        runtime=runtime_of,
    params:
        options={"faces": config["view"]["faces"]},
        code=CODE["view"],
    run:
        run_job("view", input, output, params, log)
