#!/bin/sh
#SBATCH --job-name=voidwalk-collect
#SBATCH --ntasks=1
#SBATCH --nodes=1
#SBATCH --cpus-per-task=1
#SBATCH --mem=@MEGABYTES@M
#SBATCH --time=@MINUTES@
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=slurm/collect-%j.log
# Collects the cases into ledger.jsonl, cases.csv and report.html, or says which are missing.
cd @OUT@ || exit 2
exec @PROGRAM@ campaign @PLAN@ --out @OUT@ --collect@OPTIONS@
