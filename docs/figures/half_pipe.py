"""Draws the half-pipe from a real run: half_pipe.py SCENE.json POSES.csv OUT.svg

SCENE.json is `cycloid scene export half-pipe`, POSES.csv is `cycloid run half-pipe --poses`.
"""

import csv
import json
import sys

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.hashsalt"] = "cycloid"  # The same run draws the same bytes.
import matplotlib.pyplot as plt

COLORS = {"circle": "#1b6ca8", "cycloid": "#d1495b"}
TICKS_BETWEEN_DOTS = 12
TICKS_SHOWN = 150  # One ride from side to side; later ones would lie over it.


def main(scene_file, poses_file, out_file):
    with open(scene_file, encoding="utf-8") as stream:
        scene = json.load(stream)
    tracks = {}
    with open(poses_file, encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            point = (float(row["x"]), float(row["y"]))
            tracks.setdefault(int(row["body"]), []).append(point)

    figure, axes = plt.subplots(figsize=(10, 3.2))
    for body in scene["bodies"]:
        for shape in body.get("shapes", []):
            if shape.get("kind") == "chain":
                axes.plot(*zip(*(p[:2] for p in shape["points"])), color="#444444", linewidth=2.5)
    for index, body in enumerate(scene["bodies"]):
        name = body.get("name", "")
        if name not in COLORS:
            continue
        track = tracks[index][: TICKS_SHOWN + 1]
        dots = track[::TICKS_BETWEEN_DOTS]
        axes.plot(*zip(*track), color=COLORS[name], linewidth=0.8, alpha=0.6)
        axes.scatter(*zip(*dots), s=60, color=COLORS[name], alpha=0.75, label=name)
    axes.set_aspect("equal")
    axes.set_ylim(-0.3, 4.0)
    axes.set_xlabel("m")
    axes.set_ylabel("m")
    axes.set_title("half-pipe: both riders start at rest at 2.6 m; a dot every 0.2 s", fontsize=10)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, loc="upper center", bbox_to_anchor=(0.423, 0.75))
    figure.tight_layout()
    figure.savefig(out_file, metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:4])
