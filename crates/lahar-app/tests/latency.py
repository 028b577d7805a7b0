#!/usr/bin/env python3
"""How long the window takes to answer a key: from the key's event to a changed pixel on the screen.

    latency.py X Y KEY [TIMES]      on $DISPLAY, where the window is open and has the keyboard

X, Y: a pixel of the screen that KEY changes each time, like one within the water for c (colors).
Needs libX11 and libXtst, which xdotool brings. window.sh's LATENCY=1 calls it.
"""

import ctypes
import statistics
import sys
import time

x11 = ctypes.CDLL("libX11.so.6")
xtst = ctypes.CDLL("libXtst.so.6")
x11.XOpenDisplay.restype = ctypes.c_void_p
x11.XDefaultRootWindow.restype = ctypes.c_ulong
x11.XGetImage.restype = ctypes.c_void_p
x11.XGetPixel.restype = ctypes.c_ulong
x11.XStringToKeysym.restype = ctypes.c_ulong

ALL_PLANES, Z_PIXMAP = ctypes.c_ulong(0xFFFFFFFF), 2
LONGEST = 5.0  # seconds: then it is no answer

display = ctypes.c_void_p(x11.XOpenDisplay(None))
assert display.value, "no display"
root = ctypes.c_ulong(x11.XDefaultRootWindow(display))


def pixel(x, y):
    image = ctypes.c_void_p(x11.XGetImage(display, root, x, y, 1, 1, ALL_PLANES, Z_PIXMAP))
    value = x11.XGetPixel(image, 0, 0)
    x11.XFree(image)
    return value


def press(keycode):
    for down in (1, 0):
        xtst.XTestFakeKeyEvent(display, keycode, down, ctypes.c_ulong(0))
    x11.XFlush(display)


def answer(x, y, keycode):
    before = pixel(x, y)
    start = time.perf_counter()
    press(keycode)
    while pixel(x, y) == before:
        if time.perf_counter() - start > LONGEST:
            sys.exit(f"the pixel {x}, {y} did not change")
    return time.perf_counter() - start


def main():
    x, y = int(sys.argv[1]), int(sys.argv[2])
    keycode = x11.XKeysymToKeycode(display, ctypes.c_ulong(x11.XStringToKeysym(sys.argv[3].encode())))
    times = []
    for _ in range(int(sys.argv[4]) if len(sys.argv) > 4 else 15):
        times.append(1000 * answer(x, y, keycode))
        time.sleep(0.4)
    middle, worst = statistics.median(times), max(times)
    print(f"key {sys.argv[3]}: median {middle:.0f} ms, longest {worst:.0f} ms of {len(times)}")


main()
