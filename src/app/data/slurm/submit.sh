#!/bin/sh
# Submits the campaign: @JOBS@.
# Options of sbatch go to every job: sh submit.sh --partition=short --account=soil
set -eu
cd @OUT@
submit() { number=$(sbatch --parsable "$@"); number=${number%%;*}; }
@PACK@submit @AFTER_PACK@"$@" slurm/array.sh
walk=$number
submit --dependency="afterany:$walk" "$@" slurm/collect.sh
echo "walks: job $walk; ledger and page: job $number; logs: "@OUT@/slurm
