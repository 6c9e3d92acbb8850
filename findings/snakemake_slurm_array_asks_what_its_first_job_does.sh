#!/usr/bin/env bash
# snakemake-executor-plugin-slurm: an array job asks for all its tasks the memory and time that one of them declares.
#
# Run with Python 3.11, snakemake 9.27.1, snakemake-executor-plugin-slurm 2.8.0. Four jobs of one rule declare 1000,
# 2000, 4000 and 8000 MB and as many minutes, by a function of the wildcard, as rules do whose need grows with their
# input. With --slurm-array-jobs=all they are sent as one array with one --mem and one -t, those of the job that
# happens to come first (plus 1 MB for the payload); SLURM then ends the larger tasks for memory or time. Sent one by
# one, each asks what it declares. Stubs stand for sbatch, sacct and the others and write down what they are asked.
#
# Seen:   one by one: --mem 1000 -t 1000, --mem 2000 -t 2000, --mem 4000 -t 4000, --mem 8000 -t 8000
#         as an array: --mem 1001 -t 1000 --array=1-4 (the job that comes first varies)
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT; cd "$folder"
${PYTHON:-python3} -m venv env
env/bin/pip install --quiet --disable-pip-version-check snakemake==9.27.1 snakemake-executor-plugin-slurm==2.8.0
mkdir stubs
cat > stubs/sbatch <<'SH'
#!/bin/sh
echo "$*" | sed 's/--wrap.*--array/--array/' | grep -oE -- '(--mem|-t) [0-9]+|--array=[0-9-]+' | tr '\n' ' ' >> "$ASKED"
echo >> "$ASKED"
wc -l < "$ASKED"  # the job's id
SH
cat > stubs/sacct <<'SH'
#!/bin/sh
case "$*" in *JobIdRaw*) for job in 1 2 3 4 1_1 1_2 1_3 1_4; do echo "$job|FAILED"; done ;; esac
SH
for name in scontrol sinfo squeue sacctmgr sshare scancel; do printf '#!/bin/sh\n' > stubs/$name; done
chmod +x stubs/*
cat > Snakefile <<'PY'
rule all:
    input: expand("{size}.txt", size=[1000, 2000, 4000, 8000])
rule write:
    output: "{size}.txt"
    resources:
        mem_mb=lambda wildcards: int(wildcards.size),
        runtime=lambda wildcards: int(wildcards.size),
    shell: "touch {output}"
PY
submit() {
  # The stubs run nothing, so the jobs fail: what counts is what was asked for.
  ASKED=$PWD/$1 PATH=$PWD/stubs:$PATH env/bin/snakemake --executor slurm --jobs 10 --keep-going \
    --slurm-init-seconds-before-status-checks 1 --latency-wait 1 "${@:2}" > "$1.log" 2>&1 || true
}
submit single
submit array --slurm-array-jobs=all
env/bin/snakemake --version; env/bin/pip list 2> /dev/null | grep executor
echo "one by one:"; sort "single"
echo "as an array:"; cat array
[ "$(grep -oE -- '--mem [0-9]+' single | sort -u | wc -l)" = 4 ]
[ "$(wc -l < array)" = 1 ] && grep -qE -- '--mem (1001|2001|4001|8001) ' array && grep -q -- '--array=1-4' array
