#!/usr/bin/env python3
"""Writes docs/experiments.md from the JSON of `cycloid experiments --json`.

usage: experiments_page.py REPORT.json PAGE.md
"""
import json
import sys

ROWS_MAX = 8

HEAD = """# Experiments

What the talks claim and the formulas give, beside what this solver does. Every number is measured by
`cycloid experiments`, headless, in about two seconds; a test (`EveryExperiment`) fails when one leaves
its tolerance. This page and its figures are written by `./dev experiments`; of long lists it shows some
rows, evenly spread.

Two numbers of the talks are not what their own formulas say. Ten to one takes **32** sweeps to 5 %, not
about 50: the slide's axis ends at 50, and 49 is the count to 1 %. And not every case needs two
iterations: below a ratio of 1/19 one is enough. Accuracy here is always that of the slowest contact,
max |impulse - exact| / exact, from a cold start, in the order of the ids (bottom-up).
"""


def number(value):
    return f"{value:.6g}"


def main():
    report = json.load(open(sys.argv[1], encoding="utf-8"))
    page = [HEAD]
    page.append(f"{report['checks']} numbers, {report['wrong']} out of tolerance.\n")
    for each in report["experiments"]:
        checks = each["checks"]
        page.append(f"## {each['experiment']}\n\n{each['summary']}.\n")
        page.append("| claim | expected | measured | tolerance | source |\n|---|---|---|---|---|")
        step = max(1, len(checks) / ROWS_MAX)
        shown = [checks[int(i * step)] for i in range(min(ROWS_MAX, len(checks)))]
        for check in shown:
            cells = [check["claim"].replace("|", "\\|"), number(check["expected"]),
                     number(check["measured"]), number(check["tolerance"]),
                     check["source"].replace("|", "\\|")]
            page.append("| " + " | ".join(cells) + " |")
        if len(checks) > ROWS_MAX:
            page.append(f"\nand {len(checks) - ROWS_MAX} more.")
        page.append("")
        for figure in each["figures"]:
            page.append(f"![{figure['title']}](figures/experiments/{figure['name']}.svg)\n")
    with open(sys.argv[2], "w", encoding="utf-8") as out:
        out.write("\n".join(page).rstrip() + "\n")


main()
