#!/bin/sh
# Runs a sweep as shards in parallel processes of this machine, and merges it.
#
#   processes.sh SWEEP.toml SHARDS OUT PROCESSES
set -eu
sweep=$1
shards=$2
out=$3
seq "$shards" | xargs -P "$4" -I @SHARD@ \
    host-sim sweep "$sweep" --quiet --threads 1 --shard "@SHARD@/$shards" --out "$out/shard-@SHARD@"
set --
for shard in $(seq "$shards"); do
    set -- "$@" "$out/shard-$shard"
done
host-sim sweep merge "$sweep" "$@" --out "$out"
