#!/usr/bin/env bash
# Radiance that was computed elsewhere, and textures: bash examples/6_radiance_maps.sh [FOLDER]
set -euo pipefail
cd "$(dirname "$0")/.."
if [ $# -gt 0 ]; then
    out=$1
    mkdir -p "$out"
else
    out=$(mktemp -d)
    trap 'rm -rf "$out"' EXIT
fi
mmxrt() {
    echo "+ mmxrt $*"
    command ${MMXRT:-cargo run --profile quick --quiet --} "$@"
}

# (a) Our own solver's table is one of the things that can be integrated. It serves any camera and any bands.
mmxrt solve scenes/phobos_site/scene.toml -o "$out/site.npz" --force
mmxrt integrate scenes/phobos_site/scene.toml --table "$out/site.npz" -o "$out/site" --force

# (b) What DART computed. Nobody has DART here, so a script makes a folder as DART would: a Lambert box on Lambert ground, by
# closed forms, seen from the zenith and from two sides. The scene is the same box: `box.obj` beside the folder.
python3 adapters/dart/synthetic_output.py "$out/synthetic_dart" --view 0 0 --view 36.87 90 --view 36.87 270
cat > "$out/synthetic_dart/scene.toml" <<'SCENE'
mmxrt_scene = 1
origin_m = [0.0, 0.0, 0.0]
mesh = [{ obj = "box.obj" }]
materials = { ground = { reflectance = 0.2 }, box = { reflectance = 0.4 } }
sun = { direction = [-0.35355339, 0.35355339, 0.8660254], distance_au = 1.0 }
thermal = { model = "off" }
observer = { position_m = [60.0, -20.0, 90.0], target_m = [0.0, 0.0, 1.0], up = [0.0, 1.0, 0.0] }
sensor = { samples = 128, lines = 128, fov_deg = 11.0, bands = { centres_um = [0.65, 1.05] } }
SCENE
# Its inputs are not there, so that a map file says where the scene lies in DART's frame: its origin in the middle of 12 x 16 m.
cat > "$out/synthetic_dart/dart.toml" <<'MAP'
mmxrt_map = 1
dart = "output"
origin_in_dart_m = [6.0, 8.0, 0.0]
MAP
mmxrt inspect "$out/synthetic_dart/output"
# The camera sees walls that no image shows: it must be said what to do there. Here the scene's own light fills them.
mmxrt integrate "$out/synthetic_dart/scene.toml" --radiance "$out/synthetic_dart/dart.toml" --unknown solve -o "$out/box" --force

# (c) Terrain with a texture: factors of the reflectance on a plane, their mean made 1. Texels of 1 m, facets of some 10 m, pixels of 8 m.
mmxrt landscape benches/landscape_2e5.toml -o "$out/hills.obj" --force
awk 'BEGIN {
    for (row = 0; row < 2000; row++) {
        line = ""
        for (column = 0; column < 2000; column++) {
            ring = sin(0.04 * sqrt((row - 700) ^ 2 + (column - 1200) ^ 2))
            line = line (column ? "," : "") sprintf("%.3f", 1 + 0.5 * ring + 0.3 * ((row + column) % 2))
        }
        print line
    }
}' > "$out/rings.csv"
for name in plain textured; do
    texture=""
    if [ $name = textured ]; then
        texture=', texture = { raster = "rings.csv", quantity = "factor", placement = "plane", plane = { corner_m = [-1000, 1000, 0], along_line_m = [1, 0, 0], line_to_line_m = [0, -1, 0] } }'
    fi
    cat > "$out/$name.toml" <<SCENE
mmxrt_scene = 1
origin_m = [0.0, 0.0, 0.0]
mesh = [{ obj = "hills.obj" }]
sun = { direction = [1.0, 0.3, 0.8], distance_au = 1.52 }
observer = { position_m = [0.0, -40000.0, 60000.0], target_m = [0.0, 0.0, 0.0], up = [0.0, 0.0, 1.0] }
sensor = { samples = 256, lines = 256, fit = "scene", bands = { centres_um = [1.0, 2.5] } }

[materials]
phobos_blue = { reflectance = 0.07$texture }
phobos_red = { reflectance = 0.06$texture }
SCENE
    # By sunlight and heat alone: texels are what is to be seen.
    mmxrt simulate "$out/$name.toml" --model sunlight,heat -o "$out/$name" --force
done
