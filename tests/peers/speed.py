"""Measures how fast other programs compute the benchmark's dam break, in turn with `lahar bench`: medians and ratios.

Each round runs every program once, so that a drift of the machine's speed affects all of them. Absolute figures hold for
this machine at this time only; compare the ratios.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys

PEERS = {
    "taichi": "Taichi, as its examples are written",
    "taichi-tuned": "Taichi, tuned (sorted; serial or colored scatter)",
    "warp": "Warp",
    "sparkl": "sparkl (one line corrected)",
}
# Dimensions, particles per cell, and the part of a cubic meter (square meter in 2D) that the column fills.
SCENES = {"dam-3d": (3, 8, 0.25), "dam-2d": (2, 4, 0.5)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lahar", default="target/release/lahar", help="the program")
    parser.add_argument("--case", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--particles", type=float, default=1e6)
    parser.add_argument("--threads", type=int, nargs="+", default=sorted({1, os.cpu_count()}))
    parser.add_argument("--peers", nargs="*", choices=PEERS, default=list(PEERS))
    parser.add_argument("--rounds", type=int, default=5, help="times that every program runs")
    parser.add_argument("--seconds", type=float, default=4.0, help="of a timed run of a peer")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    parser.add_argument("--worker", help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.worker:
        return worker(json.loads(args.worker))
    results = [compare(args, case, threads) for case in args.case for threads in args.threads]
    if args.json:
        print(json.dumps(results, indent=2))
        return
    print("| scene | threads | program | M particle-steps/s, median | min | max | lahar is faster by |")
    print("|---|---|---|---|---|---|---|")
    for result in results:
        ours = statistics.median(result["rates"]["lahar"])
        for name, rates in result["rates"].items():
            median = statistics.median(rates)
            low, high = min(rates), max(rates)
            what = PEERS.get(name, name)
            figures = " | ".join(f"{1e-6 * rate:.2f}" for rate in (median, low, high))
            print(f"| {result['case']}, {result['particles']} | {result['threads']} | {what} | {figures} | {ours / median:.2f} |")


def compare(args, case, threads):
    """Returns the rates of all programs on one scene, one number per round."""
    dim, ppc, part = SCENES[case]
    cells = round((args.particles / (ppc * part)) ** (1 / dim))
    shown = run([args.lahar, "show", f"bench-{case}", "--set", f"dx={1 / cells!r}", "--json"])
    peers = [name for name in args.peers if dim == 3 or name not in ("warp", "sparkl")]
    if threads > 1 and "warp" in peers:
        peers.remove("warp")
    rates = {name: [] for name in ["lahar", *peers]}
    particles = None
    for number in range(args.rounds):
        measured = run([args.lahar, "bench", "--case", case, "--particles", f"{ppc * part * cells**dim:.0f}",
                        "--threads", str(threads), "--runs", "1", "--json"])["results"][0]
        rates["lahar"].append(measured["median"])
        particles = measured["particles"]
        for name in peers:
            job = {"name": name, "dim": dim, "cells": cells, "threads": threads, "seconds": args.seconds,
                   "sound_speed": shown["sound_speed"], "dt": shown["dt"]}
            rates[name].append(run([sys.executable, __file__, "--worker", json.dumps(job)]))
        now = ", ".join(f"{name} {1e-6 * rate[-1]:.2f}" for name, rate in rates.items())
        print(f"{case}, {threads} thread(s), round {number + 1}: {now}", file=sys.stderr)
    return {"case": case, "particles": particles, "threads": threads, "rates": rates}


def worker(job):
    """Runs one program once and prints its rate."""
    if job["name"] == "sparkl":
        import speed_sparkl

        print(json.dumps(speed_sparkl.measure(job)))
        return

    from speed_scene import Scene, measure

    scene = Scene(job["dim"], job["cells"], job["sound_speed"], job["dt"])
    if job["name"] == "warp":
        import speed_warp

        program = speed_warp.make(scene)
    else:
        import speed_taichi

        program = speed_taichi.make(scene, job["name"] == "taichi-tuned", job["threads"])
    print(json.dumps(measure(scene, *program, seconds=job["seconds"])))


def run(command):
    """Returns the JSON that a command prints: its whole output, or the last line."""
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stderr}")
    try:
        return json.loads(done.stdout)
    except json.JSONDecodeError:
        return json.loads(done.stdout.splitlines()[-1])


if __name__ == "__main__":
    main()
