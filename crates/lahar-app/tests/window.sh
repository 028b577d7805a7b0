#!/bin/bash
# Opens the window on a virtual screen, presses keys and buttons as a person would, and takes pictures.
#
#   tests/window.sh PROGRAM      pictures go to $OUT (default: out/window)
#
# $SCALE: pixels a point (1). $SLOW: a factor on every wait (1). WGPU_BACKEND=gl draws by OpenGL.
# $MEASURE=1: no tour; speed and answering time instead (see docs/window.md).
#
# Needs Debian's xvfb openbox xdotool imagemagick mesa-vulkan-drivers libxkbcommon-x11-0 libx11-xcb1
# libxcursor1 libxi6 libxrandr2; with WGPU_BACKEND=gl also libegl1 libgl1-mesa-dri; to measure, python3.
set -u
out=${OUT:-out/window}
mkdir -p "$out"
XDG_RUNTIME_DIR=$(mktemp -d)
export XDG_RUNTIME_DIR WINIT_X11_SCALE_FACTOR=${SCALE:-1}
unset WAYLAND_DISPLAY
here=$(dirname "$(realpath "$0")")
program=$(realpath "$1")

# A screen with a number that nobody has.
size=$((1280 * ${SCALE:-1}))x$((800 * ${SCALE:-1}))
coproc SCREEN { exec Xvfb -displayfd 1 -screen 0 "${size}x24" -nolisten tcp 2>"$out/xvfb.log"; }
read -r number <&"${SCREEN[0]}"
export DISPLAY=:$number
openbox >/dev/null 2>&1 &
manager=$!
app=
finish() {
    kill $app "$manager" "$SCREEN_PID" 2>/dev/null
    rm -rf "$XDG_RUNTIME_DIR"
}
trap finish EXIT
sleep 0.5

# open WORDS...: the program, until its window is there
open() {
    (cd "$out" && exec "$program" "$@" >app.log 2>&1) &
    app=$!
    window=
    for _ in $(seq 120); do
        window=$(xdotool search --onlyvisible --name '^lahar$' 2>/dev/null | head -1)
        [ -n "$window" ] && break
        sleep 0.25
    done
    [ -n "$window" ] || { echo "no window; app.log says:"; cat "$out/app.log"; exit 1; }
    xdotool windowactivate --sync "$window"
}
# shut: Esc closes it, with exit code 0
shut() {
    press Escape
    for _ in $(seq 40); do
        kill -0 "$app" 2>/dev/null || break
        sleep 0.1
    done
    kill -0 "$app" 2>/dev/null && { echo "Esc did not close the window"; exit 1; }
    wait "$app" || { echo "closed with an error:"; tail -3 "$out/app.log"; exit 1; }
    app=
}
rest() { sleep "$(awk "BEGIN { print $1 * ${SLOW:-1} }")"; }
picture() { import -window "$window" "$out/$1.png" && echo "$out/$1.png"; }
press() { xdotool key --delay 60 "$@"; rest 0.4; }
# at X Y: the pointer to a point of the window
at() { xdotool mousemove --window "$window" $(($1 * ${SCALE:-1})) $(($2 * ${SCALE:-1})); }
drag() { # X Y BUTTON DX DY
    at "$1" "$2"
    xdotool mousedown "$3"
    for _ in 1 2 3 4 5 6 7 8; do xdotool mousemove_relative -- "$4" "$5"; sleep 0.06; done
    xdotool mouseup "$3"
}

if [ -n "${MEASURE:-}" ]; then
    export LP_NUM_THREADS=1
    scene=(dam-break --set bodies.0.particles_per_cell=3.334 --threads 1)
    for round in $(seq ${ROUNDS:-5}); do
        headless=$("$program" run "${scene[@]}" --frames 60 --format none -o "$XDG_RUNTIME_DIR/run-$round" --json 2>/dev/null |
            python3 -c 'import json,sys; print(json.load(sys.stdin)["particle_steps_per_second"] / 1e6)')
        open view "${scene[@]}" --trace
        press plus plus plus plus plus plus plus plus # faster than it can: it computes all the time
        sleep 10
        windowed=$(grep -o '[0-9.]* M particle-steps/s, [0-9.]* pictures/s' "$out/app.log" | tail -8 | sort -n | sed -n 4p)
        first=$(grep 'first picture' "$out/app.log")
        shut
        echo "headless $headless M particle-steps/s; window $windowed; $first"
    done
    open view "${scene[@]}"
    rest 2
    read -r x y <<<"$(xdotool getwindowgeometry --shell "$window" | awk -F= '/^X/ { x = $2 } /^Y/ { y = $2 } END { print x, y }')"
    # While it computes: the empty corner of the scene, where the hints come and go.
    python3 "$here/latency.py" $((x + 1160)) $((y + 30)) h
    # By way of the solver, in the water at the floor's left; paused, lest the water change its color.
    press space
    python3 "$here/latency.py" $((x + 330)) $((y + 600)) c
    shut
    exit 0
fi

open
rest 1.5
picture 01-start
press h
press r
rest 1
picture 02-after-r
press c
rest 1
picture 03-speed
press space
press period period
picture 04-paused
press space
press a
rest 1.5
picture 05-gravity-left
press Down
at 480 560
xdotool mousedown 1
rest 1.2
picture 06-attract
xdotool mouseup 1 mousedown 3
rest 1
picture 07-repel
xdotool mouseup 3 keydown ctrl
drag 500 560 1 30 -10
xdotool keyup ctrl
press c c c c
press minus minus minus
picture 08-slow-motion
press l
rest 4
picture 09-scenes
press Escape
press 2
rest 2
picture 10-in-3d
drag 700 350 1 25 -8
xdotool click 4 click 4
press shift+Left shift+Left ctrl+Up Next
xdotool keydown shift
at 560 420
xdotool mousedown 1
rest 1.5
picture 11-orbit-and-push
xdotool mouseup 1 keyup shift
press f
press 4
rest 2
press c c
rest 1
picture 12-pressure
press v
rest 3
picture 13-compare
press v
press p h
rest 1
picture 14-no-panel
press p h
# The panel by keys: nothing but Tab, then what has the keyboard answers to the space bar.
press Tab Tab Tab Tab space
rest 0.5
picture 15-tab
press Escape
xdotool windowsize "$window" $((760 * ${SCALE:-1})) $((520 * ${SCALE:-1}))
rest 1
picture 16-small
xdotool windowsize "$window" $((1180 * ${SCALE:-1})) $((720 * ${SCALE:-1}))
press F12
rest 1.5
picture 17-screenshot-said
press shift+r
rest 1
picture 18-default-scene
shut

open view jelly-drop --compare transfer=pic,flip,apic
rest 4
picture 19-compare-three
shut

"$program" run double-dam --frames 40 --format npz -o "$XDG_RUNTIME_DIR/run" >/dev/null 2>&1
open view "$XDG_RUNTIME_DIR/run"
rest 2
press Up Left space
press c
rest 0.7
picture 20-replay
shut

echo "all done"
