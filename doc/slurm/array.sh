#!/bin/bash
# One pack of an ensemble in each element of an array of jobs: element p makes pack p of set 1 of bed.toml, with the bits that the
# ensemble itself would give it. One that runs out of time is queued again and goes on from its checkpoint.
#   sbatch --array=1-20 array.sh
#SBATCH --job-name=packs
#SBATCH --ntasks=8
#SBATCH --time=02:00:00
#SBATCH --signal=USR2@300
scene=bed
seed=1      # that of bed.toml
p=$SLURM_ARRAY_TASK_ID
ln -sf "$scene.toml" "${scene}_1_$p.toml"   # the scene's name is that of its outputs
srun packmpi "${scene}_1_$p.toml" --seed $((seed + p - 1)) --set ensemble.packs=1 -o packs --restart auto --max-hours 1.9
code=$?
if [ "$code" -eq 75 ] && [ ! -e packs/STOP ]; then   # 75: stopped early, with a checkpoint
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_$p"
fi
exit "$code"
