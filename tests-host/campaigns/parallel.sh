#!/bin/sh
# A campaign on several machines by GNU parallel: `hosts` names them, one a line, each with this folder and the built program.
#
#   cargo build --release --package raim
#   sh tests-host/campaigns/parallel.sh tests-host/campaigns/lpv200.toml hosts
#
# Without `hosts` all runs here, one share after another on all cores. What was stopped goes on where it was.

set -eu
spec="$1"
shares=64

if [ $# -gt 1 ]; then
    seq "$shares" | parallel --sshloginfile "$2" --jobs 1 --workdir . --return "campaign-out/*.{}-of-$shares.csv" --bar \
        target/release/rai campaign "$spec" --shard "{}/$shares" --resume --out campaign-out
else
    seq "$shares" | parallel --jobs 1 --bar \
        target/release/rai campaign "$spec" --shard "{}/$shares" --resume --out campaign-out
fi
exec target/release/rai campaign merge campaign-out/*-of-"$shares".csv --out campaign-out
