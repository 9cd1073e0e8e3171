"""Training speed of model-quant and other frameworks, in interleaved rounds.

    cargo build --release -p model-quant --example training_rounds
    python rounds.py --rounds 6 --ours ../../../target/release/examples/training_rounds \\
        torch tensorflow keras

All train the reference network. Each round runs every trainer for 3 s, so that a busy machine slows
all of them alike; the table has the medians. `--python NAME=PATH` runs a trainer with a separate
interpreter.
"""

import argparse
import pathlib
import statistics
import subprocess
import sys

arguments = argparse.ArgumentParser()
arguments.add_argument("others", nargs="*", default=["torch"])
arguments.add_argument("--rounds", type=int, default=6)
arguments.add_argument("--ours", required=True)
arguments.add_argument("--python", action="append", default=[], metavar="NAME=PATH")
arguments = arguments.parse_args()

pythons = dict(item.split("=", 1) for item in arguments.python)
worker = str(pathlib.Path(__file__).with_name("worker.py"))
commands = {"model-quant": [arguments.ours, "reference"], "model-quant, 15/30/30 channels": [arguments.ours, "odd"]}
commands["model-quant, portable"] = [arguments.ours, "portable"]
for name in arguments.others:
    commands[name] = [pythons.get(name, sys.executable), worker, name]
running = {
    name: subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    for name, command in commands.items()
}
found = {name: [] for name in running}
for _ in range(arguments.rounds + 1):
    for name, process in running.items():
        process.stdin.write("go\n")
        process.stdin.flush()
        found[name].append(int(process.stdout.readline()))
print("| trainer | samples/s, median | lowest | highest | over torch, median of rounds |\n|---|---|---|---|---|")
for name, speeds in found.items():
    # The first round warms up.
    speeds, reference = speeds[1:], found.get("torch", speeds)[1:]
    ratio = statistics.median(a / b for a, b in zip(speeds, reference))
    print(f"| {name} | {statistics.median(speeds):.0f} | {min(speeds)} | {max(speeds)} | {ratio:.2f} |", flush=True)
for process in running.values():
    process.stdin.close()
    process.wait()
