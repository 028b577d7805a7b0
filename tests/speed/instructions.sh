#!/usr/bin/env bash
# Counts the instructions per particle and substep with callgrind, whose counts do not depend on the load of the machine.
# Fails if a scene takes 3 % more than tests/speed/instructions.txt says, and asks for a new file if one takes 3 % less.
# With LAHAR_UPDATE=1 it writes that file.
#
#   tests/speed/instructions.sh [PROGRAM]     target/release/lahar if not given
#
# Small scenes in motion run on one thread, with AVX2 and the portable instruction set. Valgrind has no AVX-512, and an
# older one may lack an instruction of AVX2: that row is then left out with a message. Each scene runs twice, for a short
# and for a long frame; the difference is due to substeps alone.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
lahar=$(realpath "${1:-$root/target/release/lahar}")
committed=$root/tests/speed/instructions.txt
command -v valgrind >/dev/null || { apt-get update -q && apt-get install -y -q valgrind; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

# Prints the instructions and the particle-steps of a frame; returns 2 if valgrind does not know an instruction.
count() { # scene dx set frame_rate
    if ! valgrind --tool=callgrind --callgrind-out-file=/dev/null "$lahar" run "$1" --set "dx=$2" --isa "$3" \
        --set "frame_rate=$4" --frames 1 --format none --threads 1 -o run --overwrite >/dev/null 2>log; then
        grep -q 'unhandled instruction' log && return 2
        cat log >&2
        return 1
    fi
    awk '/Collected/ { printf "%s ", $NF }' log
    awk -F'[:, ]+' '/"particle_steps"/ { print $3 }' run/run.json
}

# Prints the instructions per particle and substep as a line of the file.
measure() { # scene dx set
    local short long
    if short=$(count "$1" "$2" "$3" 4000) && long=$(count "$1" "$2" "$3" 20); then
        echo "$1 $3 $short $long" | awk '{ printf "%s %s %.1f\n", $1, $2, ($5 - $3) / ($6 - $4) }'
    elif [ $? = 2 ]; then
        echo "$1 $3 unknown"
    else
        exit 1
    fi
}

for set in avx2 portable; do
    measure bench-dam-3d 0.08333333333333333 "$set"
    measure bench-dam-2d 0.025 "$set"
    measure bench-jelly-3d 0.08333333333333333 "$set"
    measure bench-snow-3d 0.08333333333333333 "$set"
done >found

if [ -n "${LAHAR_UPDATE:-}" ]; then
    {
        echo "# Instructions per particle and substep, by tests/speed/instructions.sh with LAHAR_UPDATE=1."
        grep -v unknown found
    } >"$committed"
fi
awk '
    { name = sprintf("%-14s %-8s", $1, $2) }
    FNR == NR { if ($1 !~ /^#/) before[name] = $3; next }
    $3 == "unknown" { print name, "not counted: this valgrind lacks an instruction"; next }
    !(name in before) { print name, $3, "is not in the file"; bad = 1; next }
    {
        ratio = $3 / before[name]
        printf "%s %8.1f instructions per particle and substep, %.3f of the committed count\n", name, $3, ratio
        if (ratio > 1.03) bad = 1
        if (ratio < 0.97) better = 1
    }
    END {
        if (bad) print "3 % more than committed: if the gain is worth it, commit new counts by LAHAR_UPDATE=1 tests/speed/instructions.sh"
        else if (better) print "3 % less than committed: commit new counts by LAHAR_UPDATE=1 tests/speed/instructions.sh"
        exit bad
    }' "$committed" found
