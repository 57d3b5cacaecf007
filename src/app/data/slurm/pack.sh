#!/bin/sh
#SBATCH --job-name=voidwalk-pack
#SBATCH --array=1-@TASKS@
#SBATCH --ntasks=1
#SBATCH --nodes=1
#SBATCH --cpus-per-task=@PROCESSORS@
#SBATCH --mem=@MEGABYTES@M
#SBATCH --time=@MINUTES@
#SBATCH --signal=B:TERM@120
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=slurm/pack-%A_%a.log
# Packs the grains of @TASKS@ filters, each once; the cases are walked after it.
# Estimated: @ESTIMATE@.
cd @OUT@ || exit 2
exec sh slurm/attempt.sh @PROGRAM@ campaign @PLAN@ --out @OUT@ \
    --make-packing "$SLURM_ARRAY_TASK_ID"@OPTIONS@
