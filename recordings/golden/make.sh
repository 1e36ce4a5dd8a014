#!/usr/bin/env bash
# Records the golden sessions anew: all, or those named. For a change of bits that is meant; say so in the CHANGELOG.
#   cargo build --release && recordings/golden/make.sh [NAME…]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
palpate=$(realpath "${PALPATE:-$root/target/release/palpate}")
port=${PORT:-7799}
wanted=("$@")

# record NAME SCENE SECONDS TOOL:MOTION:DEPTH:DEVICE:SEED…
record() {
  local name=$1 scene=$2 seconds=$3
  shift 3
  if ((${#wanted[@]})) && [[ " ${wanted[*]} " != *" $name "* ]]; then return; fi
  local file=$here/$name.mcap endpoint=tcp/127.0.0.1:$port devices=()
  rm -f "$file" "$file.part"
  "$palpate" serve "$root/$scene" --clock lockstep --for "$seconds" --record "$file" --listen "$endpoint" --no-rt ${VIEWS---no-views} \
    >/dev/null 2>&1 &
  local daemon=$!
  until (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; do sleep 0.1; done
  for hand in "$@"; do
    IFS=: read -r tool motion depth device seed <<<"$hand"
    "$palpate" device --tool "$tool" --motion "$motion" --depth "$depth" --device "$device" --seed "$seed" --tremor 1e-4 \
      --for "$seconds" --connect "$endpoint" >/dev/null 2>&1 &
    devices+=($!)
  done
  wait "$daemon"
  wait "${devices[@]}" || true
  describe "$name"
}

# describe NAME: its hash in the table, its figures beside it
describe() {
  local name=$1 file=$here/$1.mcap hash
  hash=$("$palpate" replay "$file" | grep -o 'session hash [0-9a-f]*' | cut -d' ' -f3)
  "$palpate" replay "$file" --check figures --bless >/dev/null
  sed -i "/$name.mcap/s/\`[0-9a-f]\{16\}\`/\`$hash\`/" "$here/README.md"
  echo "$name $hash $(stat -c %s "$file") bytes"
}

# scenario NAME SCENARIO RUN SECONDS
scenario() {
  local name=$1
  if ((${#wanted[@]})) && [[ " ${wanted[*]} " != *" $name "* ]]; then return; fi
  rm -f "$here/$name.mcap" "$here/$name.mcap.part"
  # A bar that a short run misses is no matter here.
  "$palpate" scenario "$2" --run "$3" --for "$4" --record "$here/$name.mcap" >/dev/null 2>&1 || [ $? = 1 ]
  describe "$name"
}

VIEWS="" record rigid-teardrop-press scenes/rigid-teardrop.toml 1500ms ball:press:0.004:ideal:3
record small-lattice-press recordings/golden/small-lattice.toml 1500ms ball:press:0.004:ideal:3
record two-drops-press scenes/two-drops.toml 1500ms ball:press:0.03:ideal:3
record teardrop-tap scenes/teardrop.toml 700ms ball:tap:0.006:touch:4
record sheet-tap scenes/sheet.toml 1200ms pen:tap:0.005:ideal:5
record vessel-tap scenes/vessel.toml 1200ms pen:tap:0.004:ideal:10
record four-hands scenes/four-hands.toml 800ms tip:tap:0.004:touch:6 ring:press:0.004:ideal:7 ball:tap:0.005:ideal:8 plate:tap:0.004:ideal:9

scenario spoon-grip spoon-grip "four grips" 700ms
scenario jelly-shake jelly-shake "8 degrees, shaken along" 1200ms
scenario two-hands two-hands "both hands" 900ms
