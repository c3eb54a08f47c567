#!/usr/bin/env bash
# From one format to another, both ways: bash examples/5_convert_to_dart.sh
set -euo pipefail
cd "$(dirname "$0")/.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
mmxrt() {
    echo "+ mmxrt $*"
    command ${MMXRT:-cargo run --profile quick --quiet --} "$@"
}

# What is read and what is written.
mmxrt convert --list

# A scene as a DART simulation: no DART is needed. What DART has no place for is said, line by line, and kept in mmxrt.toml. Of surfaces that are not
# Lambert it gets the Lambert ones of the same reflectance: this is the site with the thesis's surface.
mmxrt convert scenes/phobos_site/thesis.toml "$out/dart_phobos"
mmxrt convert --check "$out/dart_phobos"

# And back: the same scene.
mmxrt convert "$out/dart_phobos" "$out/back/scene.toml"
mmxrt convert --diff scenes/phobos_site/thesis.toml "$out/back/scene.toml"

# The surface for a modelling program, and from one: a mesh has no Sun, camera or spectra, so these are taken to be something,
# and said. Positions are f32 in glTF; what that loses is told, and kept in an attribute of our own.
mmxrt convert scenes/phobos_site/scene.toml "$out/site.glb"
mmxrt convert "$out/site.glb" "$out/from_mesh/scene.toml"

# Who cannot afford a loss says so: exit code 3, and nothing is written.
code=0
mmxrt convert scenes/phobos_site/scene.toml "$out/strict.obj" --strict || code=$?
[ "$code" -eq 3 ] && [ ! -e "$out/strict.obj" ]

# Spectra: those of a scene as an optical database, one of them at other wavelengths as a table.
mmxrt convert scenes/phobos_site/scene.toml "$out/phobos.db"
mmxrt convert --list "$out/phobos.db"
mmxrt convert "$out/phobos.db" "$out/blue.csv" --model phobos_blue --bands 1:3:21:0.01
