#!/bin/sh
#SBATCH --job-name=voidwalk
#SBATCH --array=1-@TASKS@
#SBATCH --ntasks=1
#SBATCH --nodes=1
#SBATCH --cpus-per-task=@PROCESSORS@
#SBATCH --mem=@MEGABYTES@M
#SBATCH --time=@MINUTES@
#SBATCH --signal=B:TERM@120
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=slurm/walk-%A_%a.log
# Walks @CASES@ cases in @TASKS@ tasks; slurm/@FILE@ says which task walks which.
# Estimated: @ESTIMATE@.
cd @OUT@ || exit 2
exec sh slurm/attempt.sh @PROGRAM@ campaign @PLAN@ --out @OUT@ \
    --task "slurm/@FILE@:$SLURM_ARRAY_TASK_ID"@OPTIONS@
