"""Files of models in Snakemake's own report, which takes up outputs and inputs of rules that are flagged.

Those of models are neither, as Snakemake does not track them. So only while a
report is made, they are inputs of the rule that gathers all models.
"""

import os

from snakemake.io import report

from .layout import MODELS_FOLDER

# What is carried: the file, what it is called, and the caption that goes with it.
CARRIED = (("view.html", "page", "page.rst"), ("picture.png", "picture", "picture.rst"))
MOST = 60e6  # bytes of files in a report that is one page


def foretell_report(workflow):
    """Return a list that holds, while Snakemake makes a report, the path of it, and else nothing.

    Parameters
    ----------
    workflow : snakemake.workflow.Workflow
    """
    make, underway = workflow.create_report, []

    def make_report(report_plugin, report_settings, global_report_settings):
        underway.append(str(getattr(report_settings, "path", "") or ""))
        try:
            return make(report_plugin, report_settings, global_report_settings)
        finally:
            underway.clear()

    workflow.create_report = make_report
    return underway


def list_carried(models, report):
    """List the files of models that a report carries.

    Parameters
    ----------
    models : iterable of str
    report : str
        Path of the report: a page, which has all files within it, holds so many bytes of them; an archive, .zip, all.

    Returns
    -------
    files : list of (path, model, what it is called, name of its caption)
    left : int
        Number of models whose files are left out, by their size or because of characters in their names.
    """
    files, left, room = [], 0, float("inf") if report.endswith(".zip") else MOST
    for model in models:
        own = [
            (str(MODELS_FOLDER / model / name), model, called, caption)
            for name, called, caption in CARRIED
            if os.path.isfile(MODELS_FOLDER / model / name)
        ]
        size = sum(os.path.getsize(path) for path, *_ in own)
        if size > room or (own and set("{}<>") & set(model)):  # which the report would read as wildcards or marks
            left += 1
            continue
        room -= size
        files += own
    return files, left


def flag_files(files, captions):
    """Return the paths of :func:`list_carried`, flagged for the report.

    captions : snakemake.sourcecache.SourceFile of the folder of captions.
    """
    return [
        report(path, captions.join(caption), category="Models", labels={"model": model, "shows": called})
        for path, model, called, caption in files
    ]
