#!/bin/bash
# A chain of jobs: each goes on where the last one stopped, until the pack is written. To end the chain: touch brick/STOP.
#SBATCH --job-name=pack
#SBATCH --ntasks=64
#SBATCH --time=12:00:00
#SBATCH --signal=USR2@300
srun packmpi brick.toml -o brick --restart auto --max-hours 11.9
code=$?
if [ "$code" -eq 75 ] && [ ! -e brick/STOP ]; then   # 75: stopped early, with a checkpoint
  sbatch "$0"
fi
exit "$code"
