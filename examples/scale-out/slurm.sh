#!/bin/sh
# Runs a sweep as an array of Slurm jobs, one shard each, and merges it after the last.
#
#   slurm.sh SWEEP.toml SHARDS OUT
#
# OUT is a folder that all nodes share, with locks (`flock`) over all nodes. A job that is lost with
# its node is queued again and continues the journal of its shard.
set -eu
sweep=$1
shards=$2
out=$3
mkdir -p "$out"
array=$(sbatch --parsable --requeue --array "1-$shards" --ntasks 1 --cpus-per-task 1 \
    --output "$out/%a.log" --open-mode append \
    --wrap "host-sim sweep '$sweep' --threads 1 --shard \$SLURM_ARRAY_TASK_ID/$shards \
            --out '$out'/shard-\$SLURM_ARRAY_TASK_ID")
sbatch --dependency "afterok:$array" --ntasks 1 --output "$out/merge.log" \
    --wrap "host-sim sweep merge '$sweep' \$(seq -f '$out/shard-%.0f' $shards) --out '$out'"
