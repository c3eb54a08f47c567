#!/usr/bin/env bash
# An orbit, and two instruments over the same site: OUT=out/fly bash examples/9a_fly.sh [full]
# MacrOmega takes a band a second and follows the site; MIRS takes a strip, line by line. Without `full` both take little: half an hour becomes a minute.
# Without OUT nothing is kept.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${OUT:-$(mktemp -d)}
[ -n "${OUT:-}" ] || trap 'rm -rf "$out"' EXIT
mmxrt() {
    echo "+ mmxrt $*"
    command ${MMXRT:-cargo run --profile quick --quiet --} "$@"
}

# Mars' light comes from many directions, and a surface with a model is asked about each on every quarter of a pixel: that takes ten times as long.
model=sunlight,mars-light,heat
[ "${1:-}" != full ] || model=sunlight,heat

scenes=scenes/phobos_flight
mkdir -p "$out/flight" "$out/phobos_site"
cp scenes/phobos_site/*.csv scenes/phobos_site/site.toml "$out/phobos_site"
if [ "${1:-}" = full ]; then
    cp $scenes/*.toml "$out/flight"
else
    # The same five minutes in 10 bands of 48 x 48 pixels, and a strip of 24 lines; a coarser site.
    sed -i.bak -e 's/facets = 200_000/facets = 20_000/' "$out/phobos_site/site.toml"
    cp $scenes/macromega.toml "$out/flight/macromega.toml"
    sed -e 's/^lines = .*/lines = 24/' -e 's/06:37:50/06:39:45/' $scenes/mirs.toml > "$out/flight/mirs.toml"
    cat >> "$out/flight/macromega.toml" <<'SENSOR'
samples = 48
lines = 48
ifov_mrad = 2.667
period_s = 33.0
exposure_s = 1.0
bands = { start_um = 1.0, stop_um = 3.4, count = 10 }
SENSOR
    echo 'bands = { start_um = 1.0, stop_um = 3.5, count = 26, fwhm_um = 0.02 }' >> "$out/flight/mirs.toml"
fi

for instrument in macromega mirs; do
    mmxrt inspect "$out/flight/$instrument.toml"
    # What the instrument delivers: blurred, counted, noisy. `dn.img` is what it sends, `snr.svg` how good it is.
    mmxrt simulate "$out/flight/$instrument.toml" --model "$model" -o "$out/$instrument"
done
# By how much each band lies beside the one in the middle: `displacement.img` for every pixel, `displacement.svg` as curves.
ls "$out/macromega" "$out/mirs"

# Where a point of the ground is in the first band and in the last, and in the strip.
last=$([ "${1:-}" = full ] && echo 300 || echo 10)
for band in 1 "$last"; do
    mmxrt locate "$out/flight/macromega.toml" --ground -2743.5946,11860.0360,0.51269 --band "$band"
done
mmxrt locate "$out/flight/mirs.toml" --ground -2743.5946,11860.0360,0.51269
