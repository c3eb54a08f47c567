#!/usr/bin/env bash
# A stereo pair: two looks at one site from one pass, and the same point of the ground in both: bash examples/9b_campaign.sh
set -euo pipefail
cd "$(dirname "$0")/.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
mmxrt() {
    echo "+ mmxrt $*"
    command ${MMXRT:-cargo run --profile quick --quiet --} "$@"
}

pair=scenes/phobos_flight/stereo.toml
mmxrt campaign "$pair" -o "$out/stereo"

# What a pixel of the first image shows is found in the second one, at another place.
seen=$(mmxrt locate "$pair" --acquisition before --pixel 64.5,64.5 | tail -n 1)
echo "$seen"
ground=$(cut -d, -f5-7 <<<"$seen")
mmxrt locate "$pair" --acquisition after --ground="$ground"

# Again: all of it is there.
mmxrt campaign "$pair" -o "$out/stereo"
