#!/bin/sh
# What became of a SLURM job, in the words of snakemake-executor-plugin-cluster-generic: job_status.sh JOB
case $(sacct --jobs="$1" --allocations --noheader --parsable2 --format=State) in
  COMPLETED) echo success ;;
  BOOT_FAIL* | CANCELLED* | DEADLINE* | FAILED* | NODE_FAIL* | OUT_OF_MEMORY* | TIMEOUT*) echo failed ;;
  *) echo running ;;
esac
