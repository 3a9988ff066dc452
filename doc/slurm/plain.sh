#!/bin/bash
# One job. Ends with a checkpoint before its time is up (packmpi reads SLURM_JOB_END_TIME where Slurm sets it; --max-hours
# holds everywhere). Submit it again to go on.
#SBATCH --job-name=pack
#SBATCH --ntasks=64
#SBATCH --time=12:00:00
#SBATCH --signal=USR2@300
srun packmpi brick.toml -o brick --restart auto --max-hours 11.9
