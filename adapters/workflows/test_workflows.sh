#!/usr/bin/env bash
# A campaign as jobs of Snakemake, killed in the middle and run again, must be the same as one that nobody disturbed:
#   bash adapters/workflows/test_workflows.sh MMXRT [ENVIRONMENT]
# Snakemake comes from PyPI into the Python environment ENVIRONMENT, which is made if it is not there and else used as it is; without one, into a temporary one.
set -euo pipefail
mmxrt=$(realpath "${1:?name the program: test_workflows.sh MMXRT [ENVIRONMENT]}")
[ -x "$mmxrt" ] || { echo "$mmxrt is not there: cargo build --profile quick, or name the program"; exit 1; }
environment=${2:+$(realpath -m "$2")}
cd "$(dirname "$0")"
workflows=$PWD

acquisitions=200 per_shard=20
shards=$((acquisitions / per_shard))

work=$(mktemp -d)
running=
# The session that Snakemake leads: it and all that it has started, but nothing else.
killed() { [ -z "$running" ] || pkill -KILL -s "$running" 2>/dev/null || true; }
trap 'killed; rm -rf "$work"' EXIT

environment=${environment:-$work/environment}
snakemake=$environment/bin/snakemake
if ! [ -x "$snakemake" ]; then
    { python3 -m venv "$environment" && "$environment/bin/pip" install --quiet --disable-pip-version-check "snakemake>=9,<10"; } >/dev/null 2>&1 ||
        { echo "SKIPPED: pip cannot install Snakemake 9"; exit 77; }
fi

# An octahedron, seen from an orbit every ten seconds.
cd "$work"
cat > moon.obj <<'END'
usemtl grey
v 11000 0 0
v -11000 0 0
v 0 11000 0
v 0 -11000 0
v 0 0 11000
v 0 0 -11000
f 1 3 5
f 3 2 5
f 2 4 5
f 4 1 5
f 3 1 6
f 2 3 6
f 4 2 6
f 1 4 6
END
cat > scene.toml <<'END'
mmxrt_scene = 1
origin_m = [0.0, 0.0, 0.0]
[[mesh]]
file = "moon.obj"
coordinates = "body"
[materials]
grey = { reflectance = 0.07 }
[thermal]
model = "off"
[flight]
epoch = "2027-05-01T06:00:00 UTC"
orbit = "qso-20x27"
[sensor]
samples = 8
lines = 8
ifov_mrad = 50.0
bands = { centres_um = [1.0, 2.0] }
END
cat > campaign.toml <<END
mmxrt_campaign = 1
scene = "scene.toml"
[[acquisitions]]
name = "map"
start = "2027-05-01T06:00:00 UTC"
stop = "$(date -u -d "2027-05-01T06:00:00 UTC + $((10 * (acquisitions - 1))) seconds" +%Y-%m-%dT%H:%M:%S) UTC"
every_s = 10.0
[output]
model = "sunlight"
END

# A name with a space, and with the slash that a shell puts after a folder's. The option changes all products, so that it shows where it does not arrive.
folder="disturbed run"
lines=(--set sensor.lines=9)
flow=("$snakemake" -s "$workflows/Snakefile" --profile "$workflows/profiles/local" --cores 2 --nocolor
    --config "mmxrt=$mmxrt" campaign=campaign.toml "folder=$folder/" "acquisitions=$acquisitions" "per_shard=$per_shard" "options=${lines[*]}")
markers() { find "$folder.shards" -type f 2>/dev/null | wc -l; }
products() { find "$folder/products" -mindepth 1 -maxdepth 1 -not -name '.*' 2>/dev/null | wc -l; }
# Of shards that have no marker, so that one is half done.
loose() { echo $(($(products) - per_shard * $(markers))); }

"$mmxrt" -q campaign campaign.toml -o undisturbed --threads 1 "${lines[@]}" >/dev/null

setsid "${flow[@]}" >first.txt 2>&1 &
running=$!
until [ "$(markers)" -ge 3 ] && [ "$(loose)" -gt 0 ]; do
    kill -0 "$running" 2>/dev/null || { cat first.txt; echo "FAILED: it ended before it could be killed"; exit 1; }
    sleep 0.02
done
killed
{ wait "$running" || true; } 2>/dev/null
while pgrep -s "$running" >/dev/null; do sleep 0.02; done
running=
done_before=$(markers) products_before=$(products)
echo "killed with $done_before of $shards shards and $products_before of $acquisitions acquisitions done"
if [ "$done_before" -ge "$shards" ] || [ "$products_before" -le $((per_shard * done_before)) ]; then
    echo "FAILED: that was not in the middle of a shard"
    exit 1
fi

# A killed Snakemake leaves its lock.
"${flow[@]}" --unlock >unlocked.txt 2>&1 || { cat unlocked.txt; exit 1; }
setsid "${flow[@]}" >second.txt 2>&1 &
running=$!
wait "$running" || { cat second.txt; echo "FAILED: the second run"; exit 1; }
running=
made=$(grep -c '"state":"done"' second.txt) || true
echo "then made $made, to $(markers) shards and $(products) acquisitions"

# run.json says how long things took; all else is the same, byte by byte, and so are the names of what is there.
names() { (cd "$1" && find . -printf '%y %p\n' | sort); }
problems=0
problem() { echo "FAILED: $*"; problems=$((problems + 1)); }
[ "$made" -eq $((acquisitions - products_before)) ] || problem "$made acquisitions were made of $((acquisitions - products_before)) that were missing"
[ "$(products)" -eq "$acquisitions" ] || problem "$(products) acquisitions instead of $acquisitions"
[ "$(markers)" -eq "$shards" ] || problem "$(markers) markers instead of $shards"
diff <(names undisturbed) <(names "$folder") || problem "other files are there"
diff -rq --exclude=run.json undisturbed "$folder" || problem "files differ"
echo "$(find undisturbed -type f -not -name run.json | wc -l) files compared, manifest.json among them"

# Beyond all ephemerides: its shard leaves no marker, the others go on, and the manifest says what is missing. Mended, it is made.
cat >> campaign.toml <<'END'
[[acquisitions]]
name = "never"
epoch = "2040-05-01T00:00:00 UTC"
END
states() { grep -c "\"state\": \"$1\"" "$folder/manifest.json" || true; }
flow+=("acquisitions=$((acquisitions + 1))")
failing=$((acquisitions % (shards + 1) + 1))-of-$((shards + 1))
if "${flow[@]}" >failing.txt 2>&1; then problem "an acquisition that failed was not told"; fi
[ ! -e "$folder.shards/$failing" ] || problem "a shard that failed has a marker"
others=$(find "$folder.shards" -name "*-of-$((shards + 1))" | wc -l)
[ "$others" -eq "$shards" ] || problem "$others shards without a failure have a marker, not $shards"
[ "$(states done) $(states failed)" = "$acquisitions 1" ] || problem "$(states done) done and $(states failed) failed, not $acquisitions and 1"
echo "one that fails: $(states done) done, $(states failed) failed, $others of $((shards + 1)) markers"
sed -i 's/2040-05-01/2027-05-01/' campaign.toml
"${flow[@]}" >mended.txt 2>&1 || { cat mended.txt; problem "the run after mending"; }
[ "$(states done) $(states failed)" = "$((acquisitions + 1)) 0" ] || problem "$(states done) done and $(states failed) failed after mending"
[ -e "$folder.shards/$failing" ] || problem "the mended shard has no marker"

[ "$problems" -eq 0 ] || { echo "$problems problems"; exit 1; }
echo "PASSED"
