#!/usr/bin/env bash
# snakemake-executor-plugin-slurm-jobstep: the step inside a job does not see SLURM_CONF, by which SLURM's commands find
# the configuration of their cluster.
#
# Run with Python 3.11, snakemake 9.27.1, snakemake-executor-plugin-slurm-jobstep 0.6.1. Before it calls srun, the
# plugin drops all variables that begin with SLURM_ but ten; SLURM_CONF is not among the ten. Where slurm.conf is not at
# the compiled-in place, and SLURM_CONF says where it is, sbatch and sacct of the main process work, every job starts,
# and then ends as its srun finds no configuration, or that of another cluster. A stub stands for srun and writes down
# what it sees.
#
# Seen:   in the job: /etc/other/slurm.conf; in its srun: unset
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT; cd "$folder"
${PYTHON:-python3} -m venv env
env/bin/pip install --quiet --disable-pip-version-check snakemake==9.27.1 snakemake-executor-plugin-slurm-jobstep==0.6.1
mkdir stubs
cat > stubs/srun <<'SH'
#!/bin/sh
echo "${SLURM_CONF:-unset}" > "$SEEN"
while [ "${1#-}" != "$1" ]; do shift; done
exec sh -c "$*"
SH
chmod +x stubs/srun
cat > Snakefile <<'PY'
rule write:
    output: "done.txt"
    shell: "touch {output}"
PY
export SLURM_CONF=/etc/other/slurm.conf SLURM_JOB_ID=1 SEEN=$PWD/seen
PATH=$PWD/stubs:$PATH env/bin/snakemake --executor slurm-jobstep --jobs 1 --nolock done.txt > log 2>&1 || { cat log; true; }
env/bin/snakemake --version; env/bin/pip list 2> /dev/null | grep executor
echo "in the job: $SLURM_CONF; in its srun: $(cat seen)"
[ "$(cat seen)" = unset ]
