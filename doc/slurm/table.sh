#!/bin/bash
# The tables of the ensemble when array.sh has made its packs; each is verified, and one that is missing is made.
#   sbatch --dependency=afterany:JOB table.sh
#SBATCH --job-name=table
#SBATCH --ntasks=8
#SBATCH --time=02:00:00
srun packmpi bed.toml -o packs --restart auto
