#!/bin/bash
# Opens the window on a virtual screen, presses keys as a person would, and takes pictures.
#
#   tests/window.sh PROGRAM [ARGUMENT]...      pictures go to $OUT (default: out/window)
#
# Needs Debian's xvfb openbox xdotool imagemagick mesa-vulkan-drivers libxkbcommon-x11-0 libx11-xcb1
# libxcursor1 libxi6 libxrandr2; with WGPU_BACKEND=gl also libegl1 libgl1-mesa-dri.
set -u
out=${OUT:-out/window}
mkdir -p "$out"
XDG_RUNTIME_DIR=$(mktemp -d)
export XDG_RUNTIME_DIR
unset WAYLAND_DISPLAY
here=$(pwd)

# A screen with a number that nobody has.
coproc SCREEN { exec Xvfb -displayfd 1 -screen 0 1280x800x24 -nolisten tcp 2>"$out/xvfb.log"; }
read -r number <&"${SCREEN[0]}"
export DISPLAY=:$number
openbox >/dev/null 2>&1 &
manager=$!
sleep 0.5

program=$(realpath "$1")
shift
(cd "$out" && exec "$program" "$@" >app.log 2>&1) &
app=$!

finish() {
    kill "$app" "$manager" "$SCREEN_PID" 2>/dev/null
    rm -rf "$XDG_RUNTIME_DIR"
}
trap finish EXIT

window=
for _ in $(seq 60); do
    window=$(xdotool search --onlyvisible --name '^lahar$' 2>/dev/null | head -1)
    [ -n "$window" ] && break
    sleep 0.25
done
[ -n "$window" ] || { echo "no window; $here/$out/app.log says:"; cat "$out/app.log"; exit 1; }
xdotool windowactivate --sync "$window"

picture() { import -window "$window" "$out/$1.png" && echo "$out/$1.png"; }
press() { xdotool key "$1"; sleep "${2:-0.4}"; }

# Longer on slow machines: a factor on every wait.
slow=${SLOW:-1}
rest() { sleep "$(awk "BEGIN { print $1 * $slow }")"; }

rest 1.5
picture 01-start
press h 0.2
rest 1
press r
rest 0.8
picture 02-after-r
press 2
rest 3
picture 03-key-2-in-3d
xdotool mousemove --window "$window" 700 350 mousedown 1
for _ in 1 2 3 4 5 6 7 8; do xdotool mousemove_relative -- 25 -8; sleep 0.08; done
xdotool mouseup 1
xdotool click 4 click 4
press c
rest 1
picture 04-orbit-speed
xdotool keydown shift mousemove --window "$window" 700 450 mousedown 1
rest 1
picture 05-shift-attracts
xdotool mouseup 1 keyup shift
press 4
rest 3
picture 06-key-4
press c
rest 0.5
picture 07-pressure
press a
rest 2
picture 08-gravity-left
xdotool mousemove --window "$window" 800 350 mousedown 1
rest 1.5
picture 09-attract
xdotool mouseup 1
press l
rest 0.6
picture 10-list
press Escape
press h
press p
rest 0.6
picture 11-no-panel
press F12
rest 1.5
picture 12-f12
press shift+r
rest 1.5
press space
picture 13-default-paused
press Escape
rest 1
if kill -0 "$app" 2>/dev/null; then
    echo "Esc did not close the window"
    exit 1
fi
wait "$app"
code=$?
echo "closed with code $code"
exit "$code"
