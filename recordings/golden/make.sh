#!/usr/bin/env bash
# Golden sessions: all, or those named.
#   cargo build --release
#   recordings/golden/make.sh --bless [NAME…]   writes the hashes and figures of this build beside their inputs, which stay
#   recordings/golden/make.sh [NAME…]           records other inputs
# For a change of bits that is meant; say so in the CHANGELOG.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
palpate=$(realpath "${PALPATE:-$root/target/release/palpate}")
port=${PORT:-7799}
bless=0
if [[ ${1-} == --bless ]]; then bless=1 && shift; fi
wanted=("$@")
# Kept whole: with views, for viewers; of a soft body, for readers of recordings.
whole=" rigid-teardrop-press teardrop-tap "

# keep NAME: the inputs of its new recording, or all of it, with hashes and figures beside them
keep() {
  local file=$scratch/$1.mcap out=$here/$1.inputs.mcap
  if [[ $whole == *" $1 "* ]]; then
    mv "$file" "$here" && "$palpate" replay "$here/$1.mcap" --check hashes --bless
  else
    rm -f "$out" "$out.figures.json"
    "$palpate" export "$file" --inputs "$out"
  fi
}

# begin NAME: false if it is not wanted, or only blessed
begin() {
  if ((${#wanted[@]})) && [[ " ${wanted[*]} " != *" $1 "* ]]; then return 1; fi
  ((bless)) || return 0
  local files=("$here/$1".*mcap)
  "$palpate" replay "${files[0]}" --check hashes --bless || exit
  return 1
}

# record NAME SCENE SECONDS TOOL:MOTION:DEPTH:DEVICE:SEED…
record() {
  local name=$1 scene=$2 seconds=$3
  shift 3
  begin "$name" || return 0
  local endpoint=tcp/127.0.0.1:$port devices=()
  "$palpate" serve "$root/$scene" --clock lockstep --for "$seconds" --record "$scratch/$name.mcap" --listen "$endpoint" --no-rt \
    ${VIEWS---no-views} >/dev/null 2>&1 &
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
  keep "$name"
}

# scenario NAME SCENARIO RUN SECONDS
scenario() {
  begin "$1" || return 0
  # A bar that a short run misses is no matter here.
  "$palpate" scenario "$2" --run "$3" --for "$4" --record "$scratch/$1.mcap" >/dev/null 2>&1 || [ $? = 1 ]
  keep "$1"
}

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
VIEWS="" record rigid-teardrop-press scenes/rigid-teardrop.toml 1350ms ball:press:0.004:ideal:3
record small-lattice-press recordings/golden/small-lattice.toml 1500ms ball:press:0.004:ideal:3
record small-net-tap recordings/golden/small-net.toml 250ms ball:tap:0.006:ideal:11
record two-drops-press scenes/two-drops.toml 1500ms ball:press:0.03:ideal:3
record teardrop-tap scenes/teardrop.toml 650ms ball:tap:0.006:touch:4
record sheet-tap scenes/sheet.toml 1200ms pen:tap:0.005:ideal:5
record vessel-tap scenes/vessel.toml 1200ms pen:tap:0.004:ideal:10
record bracket-slide scenes/bracket.toml 2400ms ball:slide:0.003:ideal:3
record bracket-tool-press scenes/bracket-tool.toml 1200ms bracket:press:0.012:ideal:3
record four-hands scenes/four-hands.toml 1050ms tip:tap:0.004:touch:6 ring:press:0.004:ideal:7 ball:tap:0.005:ideal:8 plate:tap:0.004:ideal:9

scenario spoon-grip spoon-grip "four grips" 700ms
scenario jelly-shake jelly-shake "8 degrees, shaken along" 1200ms
scenario two-hands two-hands "both hands" 900ms
scenario cut-in-three "$here/small-cut" "two cuts" 600ms
