"""What tests of the tool's commands share.

The first two arguments of such a test are the tool and the folder of the project's meshes. Importing this takes them
off sys.argv.
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest

RAYCONE, MESHES = (os.path.abspath(sys.argv.pop(1)) for _ in range(2))
SKIPPED = 77  # exit status, for CTest
PATIENCE = 120  # seconds; more hangs, however busy the machine is
SURFACE = "closed,oriented,outward,manifold,embedded"  # what `info --require` is asked about surfaces


def numpy_or_skip():
    """The module; without it the whole test is skipped."""
    try:
        import numpy
    except ImportError:
        print("no numpy in %s: skipped" % sys.executable)
        sys.exit(SKIPPED)
    return numpy


def run_tests():
    """All of the script. It counts as skipped where one of them is."""
    result = unittest.main(exit=False).result
    sys.exit(1 if not result.wasSuccessful() else SKIPPED if result.skipped else 0)


def mesh(name):
    """The path of one of the project's meshes, NAME.obj."""
    return os.path.join(MESHES, name + ".obj")


def read(path):
    with open(path, "rb") as file:
        return file.read()


def read_json(path):
    return json.loads(read(path))


def write(path, content):
    """Text or bytes; the path."""
    with open(path, "wb") as file:
        file.write(content.encode() if isinstance(content, str) else content)
    return path


def run(words, **options):
    return subprocess.run([RAYCONE, *words.split()], capture_output=True, timeout=PATIENCE, **options)


def enter_empty_folder(add_cleanup):
    """It is left, and is gone, after the cleanups that are added."""
    directory = tempfile.TemporaryDirectory()
    add_cleanup(directory.cleanup)
    add_cleanup(os.chdir, "/")
    os.chdir(directory.name)


class CommandCase(unittest.TestCase):
    """Each test in an empty folder of its own."""

    def setUp(self):
        enter_empty_folder(self.addCleanup)

    def works(self, words, **options):
        """Standard output of a run that has nothing to say beside."""
        result = run(words + " --quiet", **options)
        self.assertEqual((result.returncode, result.stderr), (0, b""), words)
        return result.stdout

    def reported(self, words):
        """What a run that works says."""
        result = run(words)
        self.assertEqual(result.returncode, 0, (words, result.stderr))
        return result.stderr.decode()

    def refused(self, words, status, expected, **options):
        """With one line, which contains `expected`, and nothing else."""
        result = run(words, **options)
        self.assertEqual((result.returncode, result.stdout), (status, b""), (words, result.stderr))
        self.assertRegex(result.stderr, rb"\Araycone: [^\n]*\n\Z", words)
        self.assertIn(expected, result.stderr.decode(errors="replace"), words)
