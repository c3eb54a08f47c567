#!/usr/bin/env bash
# Draws the pictures of docs/landscapes.md: bash docs/landscapes.sh. Takes some minutes.
set -euo pipefail
cd "$(dirname "$0")/.."
mmxrt=${MMXRT:-"cargo run --profile quick --quiet --"}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# picture NAME RECIPE SUN: an image of a preset, 256 x 256, one band, lit as the lines SUN say.
picture() {
    cat > "$work/scene.toml" <<END
mmxrt_scene = 1
origin_m = [-2743.5946, 11860.0360, 0.51269]

[[mesh]]
recipe = "$2"

[materials]
phobos_blue = { reflectance = 0.07 }
phobos_red = { reflectance = 0.12 }

$3

[sensor]
samples = 256
lines = 256
fit = "scene"
bands = { centres_um = [1.0] }
END
    $mmxrt simulate "$work/scene.toml" -o "$work/$1" --model sunlight,mars-light --quiet
    cp "$work/$1/quicklook.png" "docs/landscapes/$1.png"
}

table_i='[sun]
position_m = [3.992e10, 2.1812e11, 1.1501e10]
[mars]
position_m = [9.376e6, 0.0, 0.0]
[observer]
position_m = [-20159.4581, 87145.4911, 3.7671]
target_m = [-2743.5946, 11860.0360, 0.51269]
up = [0.0, 0.0, 1.0]'

# at INCIDENCE: the Sun so far from the zenith in the south-west, the camera 77 km straight above.
at() {
    printf '[sun]\ndistance_au = 1.4842525\n[mars]\nposition_m = [9.376e6, 0.0, 0.0]\n[geometry]\nincidence_deg = %s\nsun_azimuth_deg = 235.0\nemission_deg = 0.0\nobserver_azimuth_deg = 0.0\naltitude_m = 77273.6\nup = "north"\n' "$1"
}

for n in 1 2 3; do
    picture "phobos-$n-table-i" "phobos-$n" "$table_i"
    picture "phobos-$n-60" "phobos-$n" "$(at 60.0)"
    picture "phobos-$n-85" "phobos-$n" "$(at 85.0)"
done
for kind in rugged many-craters few-craters dunes highland mare groove rim photo; do
    picture "$kind" "$kind" "$(at 65.0)"
done
