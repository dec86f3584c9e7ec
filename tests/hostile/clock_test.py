"""Clocks that are wrong, jump or run backwards: python3 clock_test.py RAYCONE MESH_DIRECTORY

libfaketime tells runs another date, and lets it pass a hundred thousand times faster, or backwards. Values stay the same,
a batch's second run finds all its outputs up to date, and times that are told are those of the steady clock, which no
system sets. Times of files are as they are: the library would tell each process others. Status 77 where libfaketime is
missing, or RAYCONE is built with a sanitizer, which must be loaded first.
"""

import glob
import json
import os
import subprocess
import sys
import tempfile

from runs import MESHES, OPEN, RAYCONE, contents, fail, is_sanitized, report

LIBRARIES = glob.glob("/usr/lib/*/faketime/libfaketime.so.1")
CLOCKS = ["@1969-12-31 23:59:59", "@2200-01-01 00:00:00", "+0 x100000", "-1000d x-100000"]


def under(clock, *arguments):
    environment = dict(os.environ, LD_PRELOAD=LIBRARIES[0], FAKETIME=clock, FAKETIME_DONT_FAKE_MONOTONIC="1", NO_FAKE_STAT="1")
    result = subprocess.run([RAYCONE, *arguments, "--threads", "2"], env=environment, capture_output=True, timeout=300)
    if result.returncode != 0:
        fail("%s under the clock %s" % (arguments[0], clock), result.returncode, result.stderr)
    return result


def check_values(clock, expected):
    result = under(clock, "lattice", OPEN, "--resolution", "24", "-o", "out.vdb", "--report", "out.json")
    if contents("out.vdb") != expected:
        fail("other values under the clock %s" % clock, result.returncode, result.stderr)
    seconds = json.loads(contents("out.json"))["seconds"]
    if not all(0 <= seconds[key] < 60 for key in seconds):
        fail("under the clock %s it took %s" % (clock, seconds), result.returncode, result.stderr)


def check_batch(clock, directory):
    for expected in (b" meshes done, 0 failed", b" skipped: up to date"):
        result = under(clock, "batch", MESHES, "--resolution", "8", "--out-dir", directory)
        if expected not in result.stderr:
            fail("batch under the clock %s" % clock, result.returncode, result.stderr)


# A control: what runs beside this test is told another date, too.
def fakes_the_date():
    date = subprocess.run(["date", "+%Y"], env=dict(os.environ, LD_PRELOAD=LIBRARIES[0], FAKETIME=CLOCKS[1]), capture_output=True)
    return date.stdout == b"2200\n"


with tempfile.TemporaryDirectory() as directory:
    os.chdir(directory)
    if not LIBRARIES or is_sanitized():
        print("libfaketime is missing, or of no use with sanitizers")
        sys.exit(77)
    if not fakes_the_date():
        fail("libfaketime does not fake the date", 0, b"")
    subprocess.run([RAYCONE, "lattice", OPEN, "--resolution", "24", "-o", "right.vdb", "--quiet"], check=True)
    for i, clock in enumerate(CLOCKS):
        check_values(clock, contents("right.vdb"))
        check_batch(clock, "batch%d" % i)
    os.chdir("/")
sys.exit(report())
