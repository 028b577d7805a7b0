#!/usr/bin/env bash
# Makes the films of docs/gallery.md anew. In the folder of the repository, after `cargo build --release`:
#
#   docs/images/films.sh [SCENE]...
#
# LAHAR names another binary. Without scenes, all of them.
set -euo pipefail

lahar=${LAHAR:-target/release/lahar}
films=$(cd "$(dirname "$0")" && pwd)/films
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
mkdir -p "$films"

# film SCENE FRAMES: so many frames of the scene, in 320 x 214 pixels.
film() {
    "$lahar" run "$1" --isa portable --frames "$2" --format gif \
        --set "output.picture_size=[320,214]" -o "$out/$1" > "$out/log" 2>&1 || { cat "$out/log"; exit 1; }
    cp "$out/$1/video.gif" "$films/$1.gif"
    echo "$1.gif"
}

# The scenes and how many frames of each are worth watching.
declare -A frames=(
    [dam-break]=180 [water-jelly-snow]=90 [jelly-letters]=90 [gears]=120 [snow-castle]=60
    [snowballs]=60 [honey]=120 [galaxy]=180 [knot-3d]=60 [drops-3d]=72
)
scenes=(dam-break water-jelly-snow jelly-letters gears snow-castle snowballs honey galaxy knot-3d drops-3d)
[ $# -gt 0 ] && scenes=("$@")
for scene in "${scenes[@]}"; do
    film "$scene" "${frames[$scene]}"
done
