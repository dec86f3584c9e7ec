"""Builds and tests the core once per mutant of mutants.py, in a copy of the source tree, and prints who noticed."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import mutants

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("core", "io", "tests")
TEST_SECONDS = 300  # a mutant may loop for ever; the unmutated tests take less than a minute


def mutated_texts(mutant, tree):
    """The new text of each file that the mutant changes. Every old text must be there exactly once, so that no mutant
    outlives the code that it breaks."""
    texts = {}
    for name, old, new in mutant.edits:
        text = texts.get(name) or (tree / name).read_text()
        if text.count(old) != 1:
            sys.exit(f"{mutant.name}: {name} holds {text.count(old)} times, expected once:\n{old}")
        texts[name] = text.replace(old, new)
    return texts


class DoesNotCompile(Exception):
    """What the compiler says."""


def build(build_directory):
    command = ["cmake", "--build", build_directory, "--parallel", str(os.cpu_count())]
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode != 0:
        raise DoesNotCompile(result.stdout)


def first_failing_test(build_directory):
    """The test that fails, crashes or does not end; None if all pass."""
    command = [build_directory / "core_tests", "--gtest_fail_fast", "--gtest_brief=0"]
    with tempfile.TemporaryFile("w+") as output:
        try:
            status = subprocess.run(command, stdout=output, stderr=subprocess.STDOUT, timeout=TEST_SECONDS).returncode
        except subprocess.TimeoutExpired:
            status = None
        output.seek(0)
        text = output.read()
    if status == 0:
        return None
    started = re.findall(r"^\[ RUN      \] (\S+)", text, re.MULTILINE)
    failed = re.findall(r"^\[  FAILED  \] ([^\s,]+)", text, re.MULTILINE)
    if failed:
        return failed[0]
    return f"{started[-1] if started else 'start'} ({'does not end' if status is None else 'crashes'})"


def test_mutant(mutant, tree, build_directory):
    originals = {name: (tree / name).read_text() for name, _, _ in mutant.edits}
    for name, text in mutated_texts(mutant, tree).items():
        (tree / name).write_text(text)
    try:
        build(build_directory)
        return first_failing_test(build_directory)
    finally:
        for name, text in originals.items():
            (tree / name).write_text(text)


def chosen_mutants(names):
    known = {mutant.name for mutant in mutants.MUTANTS}
    if len(known) != len(mutants.MUTANTS):
        sys.exit("Two mutants of mutants.py have one name.")
    if unknown := set(names) - known:
        sys.exit(f"No such mutant: {', '.join(sorted(unknown))}. Known are: {', '.join(sorted(known))}")
    return [mutant for mutant in mutants.MUTANTS if not names or mutant.name in names]


def main():
    if sys.argv[1:] == ["--texts"]:  # whether each can be applied, as part of the tests
        for mutant in chosen_mutants([]):
            mutated_texts(mutant, ROOT)
            if others := {name for name, _, _ in mutant.edits if name.split("/")[0] not in FOLDERS}:
                sys.exit(f"{mutant.name}: {others} is not built here")
        return 0
    chosen = chosen_mutants(sys.argv[1:])
    with tempfile.TemporaryDirectory() as directory:
        tree, build_directory = Path(directory) / "source", Path(directory) / "build"
        for folder in FOLDERS:
            shutil.copytree(ROOT / folder, tree / folder)
        for mutant in mutants.MUTANTS:
            mutated_texts(mutant, tree)  # all of them, before the first is built
        configure = ["cmake", "-S", tree / "tests/mutants", "-B", build_directory, "-DCMAKE_BUILD_TYPE=RelWithDebInfo",
                     "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O2"]  # with assertions
        subprocess.run(configure, check=True, stdout=subprocess.DEVNULL)
        try:
            if failing := test_mutant(mutants.Mutant("none", "", []), tree, build_directory):
                sys.exit(f"The core fails {failing} without any mutation.")
        except DoesNotCompile as error:
            sys.exit(f"The core does not compile without any mutation:\n{error}")
        complaints = []
        print(f"{'mutant':<34} noticed by")
        for mutant in chosen:
            try:
                noticed_by = test_mutant(mutant, tree, build_directory)
                if not noticed_by:
                    complaints.append(f"No test notices {mutant.name}: {mutant.breaks}")
            except DoesNotCompile as error:
                noticed_by = "NOBODY, as it does not compile"
                complaints.append(f"{mutant.name} does not compile:\n{error}")
            print(f"{mutant.name:<34} {noticed_by or 'NOBODY'}", flush=True)
    for complaint in complaints:
        print(complaint, file=sys.stderr)
    print(f"{len(chosen) - len(complaints)} of {len(chosen)} mutants noticed")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
