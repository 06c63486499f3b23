#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# status.sh JOB: prints what Snakemake expects of a Slurm job. Without it, Snakemake waits forever for a killed job.
state=$(scontrol --oneliner show job "$1" 2>/dev/null | sed -n 's/.* JobState=\([A-Z_]*\).*/\1/p')
case $state in
  COMPLETED) echo success ;;
  PENDING | CONFIGURING | RUNNING | COMPLETING | SUSPENDED | REQUEUED | RESIZING | STOPPED) echo running ;;
  *) echo failed ;; # also of a job that Slurm has forgotten
esac
