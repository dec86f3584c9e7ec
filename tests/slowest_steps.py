"""Where the time of the last run went: python3 slowest_steps.py BUILD-DIRECTORY

Prints the phases that tests/phases.sh noted since the last `sh tests/run.sh`, and the ten slowest of their steps: files
that ninja made, tests that ctest ran, files that clang-tidy read.
"""

import pathlib
import re
import sys
import time

SHOWN = 10


def phases(build):
    lines = (build / "phases.tsv").read_text().splitlines()
    return [(float(seconds), name) for seconds, name in (line.split("\t") for line in lines)]


def compiled(log):
    """Of each output of ninja its last time, in seconds."""
    seconds = {}
    for line in log.read_text().splitlines():
        fields = line.split("\t")
        if len(fields) == 5:
            seconds[fields[3]] = (int(fields[1]) - int(fields[0])) / 1000
    return [(s, f"{log.parent.name}: {name.replace('CMakeFiles/', '')}") for name, s in seconds.items()]


def tested(log):
    pattern = re.compile(r"Test +#\d+: (\S+) \.+.* ([\d.]+) sec")
    return [(float(seconds), f"{log.parent.name}: test {name}") for name, seconds in pattern.findall(log.read_text())]


def tidied(log):
    return [(float(seconds), f"clang-tidy {name}")
            for seconds, name in (line.split("\t") for line in log.read_text().splitlines())]


def main(build):
    build = pathlib.Path(build)
    all_phases = phases(build)
    since = time.time() - sum(seconds for seconds, _ in all_phases) - 60
    steps = []
    for pattern, read in (("*/.ninja_log", compiled), ("*/ctest*.log", tested), ("tidy.tsv", tidied)):
        for log in build.glob(pattern):
            if log.stat().st_mtime > since:
                steps += read(log)
    print("\nTime by phase:")
    for seconds, name in all_phases:
        print(f"{seconds:8.0f} s  {name}")
    print(f"{sum(seconds for seconds, _ in all_phases):8.0f} s  in all\n\nThe ten slowest steps:")
    for seconds, name in sorted(steps, reverse=True)[:SHOWN]:
        print(f"{seconds:8.1f} s  {name}")


if __name__ == "__main__":
    main(sys.argv[1])
