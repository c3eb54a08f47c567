#!/usr/bin/env bash
# A shard of a campaign as a task of an array, of Slurm or HyperQueue:
#   SHARDS=50 sbatch --array=1-50 adapters/workflows/shard_array.sh CAMPAIGN FOLDER [OPTIONS]
#   hq submit --env SHARDS=50 --array 1-50 bash adapters/workflows/shard_array.sh CAMPAIGN FOLDER [OPTIONS]
# Afterwards once without a shard, for the manifest: mmxrt campaign CAMPAIGN -o FOLDER [OPTIONS]
set -euo pipefail
campaign=$1 folder=$2
shift 2
shard=${SLURM_ARRAY_TASK_ID:-${HQ_TASK_ID:?run this as a task of an array}}
# The array's own size will not do: it is another one when only some tasks are run again.
: "${SHARDS:?say how many shards there are}"
exec mmxrt campaign "$campaign" -o "$folder" --shard "$shard/$SHARDS" --threads "${SLURM_CPUS_PER_TASK:-1}" "$@"
