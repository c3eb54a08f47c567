#!/usr/bin/env bash
# The add-on in Blender itself: bash adapters/blender/test_in_blender.sh [MMXRT]. A few minutes, most of them in Cycles.
#
# Tried are PyPI's `bpy` (for which Python 3.11 is needed, and a GB of disk) and Debian's `blender`, each if it can be had; both if MMXRT_BLENDERS says nothing,
# else those that it names: "bpy", "debian". MMXRT_BPY is a Python that has `bpy` already. Ends with one line: N passed, N failed, N skipped.
set -euo pipefail
# As it is named from where this is run.
mmxrt=${1:+$(realpath -m "$1")}
cd "$(dirname "$0")"
source ../../.ci/steps.sh

mmxrt=${mmxrt:-$(cd ../.. && pwd)/target/quick/mmxrt}
[ -x "$mmxrt" ] || { echo "$mmxrt is not there: cargo build --profile quick, or name the program"; exit 1; }
mmxrt=$(realpath "$mmxrt")
blenders=${MMXRT_BLENDERS:-bpy debian}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Folders of add-ons as users have them: Blender 4.2 and later looks into the first, earlier ones into the second.
mkdir -p "$work/extensions/user_default" "$work/scripts/addons"
cp -r mmxrt "$work/extensions/user_default/mmxrt"
cp -r mmxrt "$work/scripts/addons/mmxrt_installed"
export BLENDER_USER_EXTENSIONS=$work/extensions BLENDER_USER_SCRIPTS=$work/scripts BLENDER_USER_CONFIG=$work/config PYTHONDONTWRITEBYTECODE=1

# As `bpy` has no command line: Blender's own checks of an extension, and the archive that users install.
extension() {
    local cli
    cli=$("$1" -c 'import bpy, os; print(os.path.join(bpy.utils.system_resource("SCRIPTS"), "addons_core", "bl_pkg", "cli", "blender_ext.py"))' | tail -n 1)
    "$1" "$cli" validate mmxrt && "$1" "$cli" build --source-dir mmxrt --output-dir "$work"
}

# What `mmxrt convert` makes of a file by Blender: a scene with all that the add-on exports, which the add-on itself has written too, and what else scenes become.
convert() {
    "$mmxrt" convert "$work/of_blender/scene.blend" "$work/converted" --to scene &&
        diff -r "$work/of_blender/scene" "$work/converted" &&
        "$mmxrt" convert "$work/of_blender/scene.blend" "$work/converted.glb" &&
        "$mmxrt" convert "$work/of_blender/scene.blend" "$work/of_dart" | grep "object fields" &&
        "$mmxrt" convert --check "$work/of_dart" || return 1
    # Its table lies in another folder now.
    mkdir "$work/elsewhere" && cp "$work/of_blender/scene.blend" "$work/elsewhere/"
    if "$mmxrt" convert "$work/elsewhere/scene.blend" "$work/elsewhere/scene.toml" 2>"$work/refused"; then return 1; fi
    grep "lies outside of the file's folder" "$work/refused" || return 1
    "$mmxrt" convert "$work/elsewhere/scene.blend" "$work/elsewhere/scene.toml" --allow-outside
}

if [[ $blenders == *bpy* ]]; then
    python=${MMXRT_BPY:-$work/bpy/bin/python}
    if [ -z "${MMXRT_BPY:-}" ]; then
        { python3.11 -m venv "$work/bpy" && "$python" -m pip install --quiet --disable-pip-version-check bpy==5.0.1; } >/dev/null 2>&1 || true
    fi
    if "$python" -c "import bpy" >/dev/null 2>&1; then
        step "pure parts in its Python" env MMXRT="$mmxrt" "$python" test_pure.py
        step "the extension" extension "$python"
        step "bpy" "$python" test_in_blender.py "$mmxrt" "$work/of_bpy"
    else
        skip "bpy" "PyPI's bpy 5.0.1 cannot be installed, or its Python 3.11 or a library of it is missing"
    fi
fi
if [[ $blenders == *debian* ]]; then
    command -v blender >/dev/null || { apt-get update && apt-get install -y --no-install-recommends blender; } >/dev/null 2>&1 || true
    if command -v blender >/dev/null; then
        step "blender" blender -b --factory-startup --python test_in_blender.py -- "$mmxrt" "$work/of_blender"
        step "convert" convert
    else
        skip "blender" "it is not installed, and apt-get cannot add it"
    fi
fi
summary
