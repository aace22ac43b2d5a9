#!/bin/sh
# A campaign on a Slurm cluster, in 64 shares; a share that was stopped goes on where it was.
#
#   cargo build --release --package raim
#   sbatch --wait tests-host/campaigns/slurm.sh tests-host/campaigns/lpv200.toml
#   target/release/rai campaign merge campaign-out/*-of-64.csv --out campaign-out
#
#SBATCH --job-name=rai-campaign
#SBATCH --array=1-64
#SBATCH --cpus-per-task=4
#SBATCH --time=04:00:00
#SBATCH --requeue
#SBATCH --output=campaign-%A-%a.log

export RAYON_NUM_THREADS="${SLURM_CPUS_PER_TASK}"
exec target/release/rai campaign "$1" --shard "${SLURM_ARRAY_TASK_ID}/64" --resume --out campaign-out
