"""What the documents tell readers to copy: python3 cookbook_test.py RAYCONE REPOSITORY

Every ```sh block of docs/cookbook.md and docs/tutorial.md, and of those sections of README.md and docs/formats.md that
use the tool, runs with `sh -e`. Where a ```text block follows, the block must have printed exactly that. A ```make block
is run as a Makefile, for the goal that the text before it names. Blocks of ```console and ```cmake are not run: they
need more than the tests install (Blender, an installation). Each section has a fresh directory with a copy of data/, in
which its blocks run in order.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

RAYCONE, REPOSITORY = (os.path.abspath(sys.argv.pop(1)) for _ in range(2))
ENVIRONMENT = {**os.environ, "PATH": os.path.dirname(RAYCONE) + os.pathsep + os.environ["PATH"]}


def sections(document):
    """Of each section its heading and its blocks: the prose before, and the code, whose first line is its language."""
    with open(os.path.join(REPOSITORY, document), encoding="utf-8") as file:
        parts = re.split(r"^## (.*)\n", file.read(), flags=re.M)[1:]
    for heading, body in zip(parts[::2], parts[1::2]):
        pieces = re.split(r"^```", body, flags=re.M)
        assert len(pieces) % 2 == 1, (document, heading, "a block has no end")
        yield heading, list(zip(pieces[::2], pieces[1::2]))


def has_nibabel():
    return subprocess.run(["/usr/bin/python3", "-c", "import nibabel"], capture_output=True, check=False).returncode == 0


class Documents(unittest.TestCase):
    def output_of(self, *command):
        result = subprocess.run(
            command, cwd=self.directory, env=ENVIRONMENT, capture_output=True, text=True, timeout=300, check=False
        )
        self.assertEqual(result.returncode, 0, (command[-1], result.stdout, result.stderr))
        return result.stdout

    def run_blocks(self, blocks):
        """How many blocks of each language there were."""
        counts = {"sh": 0, "make": 0, "text": 0, "console": 0, "cmake": 0}
        printed = None
        for prose, block in blocks:
            language, _, code = block.partition("\n")
            counts[language] += 1
            if language == "sh":
                printed = self.output_of("sh", "-e", "-c", code)
            elif language == "make":
                with open(os.path.join(self.directory, "Makefile"), "w", encoding="utf-8") as file:
                    file.write(code)
                goal = re.search(r"`make (\S+)`", prose)[1]
                self.output_of("make", goal)
                self.assertTrue(os.path.exists(os.path.join(self.directory, goal)), goal)
            elif language == "text":
                self.assertEqual(prose.strip(), "", "expected output stands directly below its block")
                self.assertEqual(printed, code)
        return counts

    def run_section(self, heading, blocks, at_least):
        with self.subTest(heading), tempfile.TemporaryDirectory() as self.directory:
            if any("import nibabel" in block for _, block in blocks) and not has_nibabel():
                self.skipTest("no nibabel in /usr/bin/python3")
            shutil.copytree(os.path.join(REPOSITORY, "data"), os.path.join(self.directory, "data"))
            counts = self.run_blocks(blocks)
            for language, least in at_least.items():
                self.assertGreaterEqual(counts[language], least, language)

    def test_recipes_of_the_cookbook_print_what_they_say(self):
        recipes = list(sections("docs/cookbook.md"))
        self.assertEqual(len(recipes), 11)
        for heading, blocks in recipes:
            self.run_section(heading, blocks, {"sh": 1, "text": 1})

    def test_commands_of_the_tutorial_print_what_it_says(self):
        blocks = dict(sections("docs/tutorial.md"))["From scan to picture"]
        languages = [block.partition("\n")[0] for _, block in blocks]
        self.assertEqual([language for language in languages if language != "text"], ["sh"] * 9 + ["console"])
        self.run_section("Tutorial", blocks, {"text": 4})

    def test_commands_of_the_formats_print_what_they_say(self):
        formats = dict(sections("docs/formats.md"))
        self.run_section("Lattices", formats["Lattices"], {"sh": 1, "text": 1})
        self.run_section("Fields", formats["Fields"], {"sh": 1, "text": 1})
        self.run_section("Output", formats["Output"], {"sh": 5, "text": 5})

    def test_commands_of_the_readme_work(self):
        readme = dict(sections("README.md"))
        self.run_section("Commands", readme["Commands to copy"], {"sh": 6, "make": 1})
        self.run_section("How accurate", readme["How accurate"], {"sh": 1})


if __name__ == "__main__":
    done = unittest.main(exit=False).result
    sys.exit(1 if not done.wasSuccessful() else 77 if done.skipped else 0)
