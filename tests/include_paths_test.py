#!/usr/bin/env python3
"""Each folder of core, io and app is compiled with an include path that shows it only what it may include.

usage: include_paths_test.py BUILD-DIRECTORY COMPILER
"""
import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

# docs/architecture.md, "Who may include whom": a folder sees itself, folders above it in its list, and those named
# here.
STEPS = ["core/data", "core/machine", "core/exact", "core/mesh", "core/crossings", "core/boundary", "core/far",
         "core/evaluation"]
BESIDE = {"core/distance": ["core/data", "core/machine", "core/exact", "core/mesh", "core/crossings"],
          "core/intersections": ["core/data", "core/machine", "core/exact", "core/mesh"],
          "core/orientation": ["core/data", "core/machine", "core/exact", "core/mesh", "core/crossings", "core/boundary"],
          "core/arrangement": ["core/data", "core/machine", "core/exact", "core/mesh", "core/intersections"],
          "core/sampling": ["core/data", "core/machine", "core/exact"]}
# The steps of a closed surface.
STEPS_AND_SEARCHES = [*STEPS, "core/distance", "core/intersections"]
SURFACE = {"core/cells": STEPS,
           "core/certificate": [*STEPS, "core/intersections", "core/cells"],
           "core/contour": [*STEPS, "core/cells"],
           "core/sharpening": [*STEPS_AND_SEARCHES, "core/cells", "core/certificate"],
           "core/merging": [*STEPS_AND_SEARCHES, "core/cells", "core/certificate"],
           "core/surface": [*STEPS_AND_SEARCHES, "core/cells", "core/certificate", "core/contour", "core/sharpening",
                            "core/merging"]}
SURFACE["core/filling"] = [*SURFACE["core/surface"], "core/arrangement", "core/surface"]
BESIDE.update(SURFACE)
FILES = ["io/files", "io/mesh", "io/points"]
FIELDS = ["io/files", "io/fields", "io/vdb"]
OF_CORE = {"core/data", "core/machine"}  # what io may see of core
# app: what each folder sees, and with it all that those see. The files in app/ itself are the top: they see everything.
APP = {"app/text": [],
       "app/process": ["app/text", "io/files", "core/machine"],
       "app/options": ["app/process", "io/fields", "io/points", "core/evaluation", "core/orientation",
                       "core/sampling"],
       "app/command_line": ["app/options"],
       "app/report": ["app/process", "io/fields", "io/mesh", "core/evaluation", "core/orientation"],
       "app/picture": ["core/data", "io/fields"],
       "app/input": ["app/options", "io/vdb"],
       "app/fields": ["app/input", "app/report", "core/distance", "core/filling"],
       "app/samples": ["app/fields", "app/picture"],
       "app/run": ["app/samples", "core/intersections"],
       "app/batch": ["app/run"],
       "app/manual": ["app/command_line"]}


def allowed(folder):
    """The folders that `folder` may see at most."""
    if folder in BESIDE:
        return {folder, *BESIDE[folder]}
    if folder in STEPS:
        return set(STEPS[:STEPS.index(folder) + 1])
    if folder.startswith("io/"):
        above = FILES if folder in FILES else FIELDS
        return OF_CORE | set(above[:above.index(folder) + 1])
    if folder in APP:
        return {folder}.union(*map(allowed, APP[folder]))
    return None


def commands(build):
    """Source file, or what stands for a folder's files, relative to the root; and the arguments that compile it."""
    build = pathlib.Path(build).resolve()
    database = subprocess.run(["ninja", "-C", build, "-t", "compdb"], check=True, capture_output=True, text=True).stdout
    for entry in json.loads(database):
        source = pathlib.Path(entry["directory"], entry["file"]).resolve()
        if source.suffix == ".cxx":  # RAYCONE_UNITY: BUILD/core/mesh/CMakeFiles/core_mesh.dir/Unity/unity_0_cxx.cxx
            yield str(source.relative_to(build)), entry["command"].split()
        elif source.suffix == ".cpp" and source.is_relative_to(ROOT):
            yield str(source.relative_to(ROOT)), entry["command"].split()


def include_paths(arguments):
    return [pathlib.Path(a[2:]) for a in arguments if a.startswith("-I")]


def folders_seen(arguments):
    """The folders of the sources that an include path shows."""
    seen = set()
    for path in include_paths(arguments):
        for layer in ("core", "io", "app"):
            within = path / layer
            if within.is_symlink():
                seen.add(layer)
            elif within.is_dir():
                seen |= {f"{layer}/{folder.name}" for folder in within.iterdir() if folder.is_dir()}
    return seen


def compiles(compiler, arguments, header):
    paths = [a for a in arguments if a.startswith("-I")]
    result = subprocess.run([compiler, "-std=c++20", *paths, "-x", "c++", "-fsyntax-only", "-"],
                            input=f'#include "{header}"\n', text=True, capture_output=True, cwd="/")
    return result.returncode == 0


def main(build, compiler):
    failures, checked, of_folder = [], 0, {}
    for source, arguments in commands(build):
        folder = "/".join(source.split("/")[:2])
        expected = allowed(folder)
        if expected is None:
            continue
        checked += 1
        of_folder[folder] = arguments
        seen = folders_seen(arguments)
        if folder not in seen:
            failures.append(f"{source}: does not see its own folder, only {sorted(seen)}")
        if seen - expected:
            failures.append(f"{source}: sees {sorted(seen - expected)}")
    if len(of_folder) < 20:
        failures.append(f"only {sorted(of_folder)} found")

    # The compiler agrees: what is allowed compiles, what lies above does not.
    for folder, header, works in [("core/mesh", "core/exact/predicates.h", True),
                                  ("core/mesh", "core/evaluation/winding_number.h", False),
                                  ("core/exact", "core/mesh/weld.h", False),
                                  ("core/exact", "io/files/file_error.h", False),
                                  ("io/mesh", "core/data/triangle_mesh.h", True),
                                  ("io/mesh", "core/mesh/weld.h", False),
                                  ("io/files", "io/mesh/read_mesh.h", False),
                                  ("app/run", "app/options/lattice_command.h", True),
                                  ("app/run", "app/command_line/parse_command_line.h", False),
                                  ("app/fields", "app/samples/slabs.h", False),
                                  ("app/input", "app/fields/fields.h", False),
                                  ("app/options", "app/batch/shard.h", False),
                                  ("app/batch", "app/command_line/batch_options.h", False)]:
        if compiles(compiler, of_folder[folder], header) != works:
            failures.append(f'{folder}: #include "{header}" {"does not compile" if works else "compiles"}')
    print("\n".join(failures) or f"{checked} sources see what they may")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
