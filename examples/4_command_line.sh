#!/usr/bin/env bash
# The command line, from a recipe to products: bash examples/4_command_line.sh
set -euo pipefail
cd "$(dirname "$0")/.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
mmxrt() {
    echo "+ mmxrt $*"
    command ${MMXRT:-cargo run --profile quick --quiet --} "$@"
}

# A landscape from a recipe: OBJ and MTL, at any number of facets.
mmxrt landscape benches/landscape_2e5.toml --facets 20000 -o "$out/ground.obj"
mmxrt inspect "$out/ground.obj"

# A scene says where things are. Spectra are tables; paths start at the scene file's folder.
cp scenes/phobos_site/*.csv "$out"
cat > "$out/scene.toml" <<'SCENE'
mmxrt_scene = 1
origin_m = [-2743.5946, 11860.0360, 0.51269]

[[mesh]]
obj = "ground.obj"
pose = "radial" # x east, y north, z outward

[materials]
phobos_blue = { reflectance = "blue_unit.csv" }
phobos_red = { reflectance = "red_unit.csv" }

[sun]
position_m = [3.992e10, 2.1812e11, 1.1501e10]

[observer]
position_m = [-20159.4581, 87145.4911, 3.7671]
target_m = [-2743.5946, 11860.0360, 0.51269]
up = [0.0, 0.0, 1.0]

[sensor]
samples = 128
lines = 128
fit = "scene"
bands = { start_um = 1.0, stop_um = 3.5, count = 26, fwhm_um = 0.02 }
SCENE

# In one step, and in two with the facet table between them: the same bytes.
mmxrt simulate "$out/scene.toml" -o "$out/at_once" --exr --footprints
mmxrt solve "$out/scene.toml" -o "$out/table.npz"
mmxrt integrate "$out/scene.toml" --table "$out/table.npz" -o "$out/in_two"
cmp "$out/at_once/cube.img" "$out/in_two/cube.img"
cmp "$out/at_once/backplanes.img" "$out/in_two/backplanes.img"

# What any of these files holds; --json for programs.
mmxrt inspect "$out/at_once"
mmxrt inspect "$out/table.npz" --json | head -n 5

# A product that exists is not replaced by accident: exit code 1, and the old one is still there.
if mmxrt simulate "$out/scene.toml" -o "$out/at_once"; then exit 1; fi
mmxrt simulate "$out/scene.toml" -o "$out/at_once" --force --interleave bil --dtype f64 --threads 1
