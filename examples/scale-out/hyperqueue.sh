#!/bin/sh
# Runs a sweep as an array of HyperQueue tasks, one shard each, and merges it.
#
#   hyperqueue.sh SWEEP.toml SHARDS OUT
#
# The server (`hq server start --journal FILE`) and at least one worker (`hq worker start`) run
# already; see docs/scale-out.md. A task that is lost with its worker is started again and continues
# the journal of its shard. The same command may be repeated after a failure.
set -eu
sweep=$1
shards=$2
out=$3
mkdir -p "$out"
hq submit --wait --array "1-$shards" --cpus 1 --crash-limit unlimited \
    --stdout none --stderr "$out/%{TASK_ID}.log" -- \
    sh -c 'exec host-sim sweep "$0" --threads 1 --shard "$HQ_TASK_ID/$1" --out "$2/shard-$HQ_TASK_ID"' \
    "$sweep" "$shards" "$out"
set --
for shard in $(seq "$shards"); do
    set -- "$@" "$out/shard-$shard"
done
host-sim sweep merge "$sweep" "$@" --out "$out"
