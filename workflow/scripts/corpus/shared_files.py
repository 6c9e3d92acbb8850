"""Where a run's files have to be: on a file system that all its jobs see."""

from .configuration import ConfigError


def check_file_sharing(settings):
    """Refuse to keep files in a storage from which Snakemake carries to each job what its rule declares.

    Rules declare status tables. The files of the models, for which these
    stand, are read and written in place, and would stay behind.

    Parameters
    ----------
    settings : snakemake.settings.types.StorageSettings

    Raises
    ------
    ConfigError
        Names the option, and what to do instead.
    """
    provider = settings.default_storage_provider
    if provider is not None:
        option = f"--default-storage-provider {provider}"
    elif "input-output" not in {str(usage) for usage in settings.shared_fs_usage}:
        option = "--shared-fs-usage without input-output"
    else:
        return
    raise ConfigError(
        f"{option} cannot be used: it would carry the status tables to and from the jobs and leave the models' files, "
        "in results/models/, behind. Leave it out, and run in a folder on a file system that all jobs share, the "
        "meshes too; without one, run on single machines, each over a share of the meshes (docs/cluster.md)"
    )
