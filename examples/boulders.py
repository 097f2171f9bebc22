#!/usr/bin/env python3
"""Compares a rocking column with shaking-table tests of two granite boulders.

    git clone https://github.com/ZhiangChen/virtual_shake_robot_pybullet
    python3 examples/boulders.py virtual_shake_robot_pybullet/data/Shake_Table_Response --program target/release/archrock

The tests, and the distinct elements that its authors computed, are in that folder: motions of the table (``Test*.txt``), outcomes
(``Results_Granite.xlsx``) and measures of intensity (``Earthquake_Records_Info.xlsx``). Tests without a motion in the copy are left out. Every
motion acts once, unscaled: a suite without levels. The width of the column is fitted. Needs Python alone.
"""

import argparse
import csv
import pathlib
import re
import subprocess
import xml.etree.ElementTree as ET
import zipfile

SCENARIO = """\
title = "Granite boulder"

[column]
height_m = {height}
width_m = 0.1

[simulation]
direction = "as_given"

[suite]
records = "{folder}/Test*.txt"
unit = "g"
acceleration_column = 2
baseline = "mean"
"""
GRAVITY = 9.81
SHEET = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"


def sheet(path):
    """The rows of the first sheet of a workbook: for each the cells by the letters of their columns."""
    with zipfile.ZipFile(path) as book:
        texts = ET.fromstring(book.read("xl/sharedStrings.xml"))
        texts = ["".join(text.text or "" for text in entry.iter(f"{SHEET}t")) for entry in texts]
        rows = ET.fromstring(book.read("xl/worksheets/sheet1.xml"))
    for row in rows.iter(f"{SHEET}row"):
        cells = {}
        for cell in row.iter(f"{SHEET}c"):
            value = cell.find(f"{SHEET}v")
            if value is not None:
                text = texts[int(value.text)] if cell.get("t") == "s" else value.text
                cells[re.match("[A-Z]+", cell.get("r")).group()] = text
        yield cells


def numbered(rows):
    """The rows that begin with the number of a test."""
    return {int(row["A"]): row for row in rows if re.fullmatch(r"\s*\d+\s*", row.get("A", ""))}


def agreement(found, measured, tests):
    """The share of tests with the measured outcome."""
    return sum(found[test] == measured[test] for test in tests) / len(tests)


def best_threshold(values, measured, tests):
    """The largest agreement of the rule that a test overturns from a value on, and this value."""
    rules = [values[test] for test in tests] + [float("inf")]
    return max((agreement({test: values[test] >= rule for test in tests}, measured, tests), rule) for rule in rules)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("copy", type=pathlib.Path, help="the folder with the tests")
    parser.add_argument("--program", default="archrock", help="the program (default: %(default)s)")
    parser.add_argument("--out", type=pathlib.Path, default="boulders", help="folder of the results (default: %(default)s)")
    parser.add_argument("--height", type=float, default=0.85, help="height of the column in m (default: %(default)s)")
    parser.add_argument("--widths", type=float, nargs=3, default=[0.07, 0.13, 0.005], metavar=("FROM", "TO", "STEP"))
    options = parser.parse_args()

    table = list(sheet(options.copy / "Results_Granite.xlsx"))
    names, results = table[0], numbered(table)
    intensities = numbered(sheet(options.copy / "Earthquake_Records_Info.xlsx"))
    peaks = {test: float(row["F"]) for test, row in intensities.items()}
    velocities = {test: float(row["E"]) * peaks[test] * GRAVITY for test, row in intensities.items()}
    tests = sorted(int(path.stem[4:]) for path in options.copy.glob("Test*.txt"))
    print(f"{len(tests)} of {len(results)} tests have a motion in this copy")

    options.out.mkdir(parents=True, exist_ok=True)
    scenario = options.out / "boulder.toml"
    scenario.write_text(SCENARIO.format(height=options.height, folder=options.copy.resolve()))
    first, last, step = options.widths
    columns = {}
    for count in range(round((last - first) / step) + 1):
        width = round(first + count * step, 6)
        folder = options.out / f"width-{width:g}"
        command = [options.program, "suite", scenario, "--set", f"column.width_m={width}", "--out", folder, "--quiet"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        with (folder / "suite.csv").open() as file:
            rows = [(int(re.search(r"Test(\d+)", row["record"]).group(1)), row) for row in csv.DictReader(file)]
        columns[width] = {test: row["outcome"] == "overturned" for test, row in rows}

    for boulder, own in ((1, "B"), (2, "C")):
        measured = {test: results[test][own] == "1" for test in tests}
        print(f"boulder {boulder}: {sum(measured.values())} tests overturn it")
        for width, found in columns.items():
            wrong = [test for test in tests if found[test] != measured[test]]
            unsafe = sum(measured[test] for test in wrong)
            print(f"  column {width:g} m wide: {agreement(found, measured, tests):.1%}, {len(wrong)} wrong, {unsafe} of them unsafe")
        middle = len(tests) // 2
        for name, one, other in (("every other test", tests[::2], tests[1::2]), ("half of the series", tests[:middle], tests[middle:])):
            for fitted, tried in ((one, other), (other, one)):
                width = max(columns, key=lambda width: agreement(columns[width], measured, fitted))
                share = agreement(columns[width], measured, tried)
                print(f"  fitted on {name}: {width:g} m; on the others: {share:.1%}")
        for measure, values in (("peak acceleration", peaks), ("peak velocity", velocities)):
            share, rule = best_threshold(values, measured, tests)
            print(f"  {measure} from {rule:.3f}: {share:.1%}")
        for letter, name in names.items():
            if f"Specimen {boulder}-Numerical" in name:
                found = {test: results[test][letter] == "1" for test in tests}
                print(f"  distinct elements {name.split('Numerical ')[1]}: {agreement(found, measured, tests):.1%}")


if __name__ == "__main__":
    main()
