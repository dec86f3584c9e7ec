"""The manual page and the completions of bash and zsh: python3 manual_test.py RAYCONE DIRECTORY

All three must know what --help lists, command by command, no more and no less; the page must be sound roff; and the
shells themselves must complete with these files.
"""

import os
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

RAYCONE, DIRECTORY = (os.path.abspath(sys.argv.pop(1)) for _ in range(2))
MAN, BASH, ZSH = (os.path.join(DIRECTORY, name) for name in ("raycone.1", "raycone.bash", "_raycone"))
PLAIN = {**os.environ, "LC_ALL": "C.UTF-8"}  # man and bash warn of a locale that is not there


def output_of(*command, **options):
    result = subprocess.run(command, capture_output=True, text=True, **options)
    assert result.returncode == 0 and not result.stderr, (command, result.returncode, result.stderr)
    return result.stdout


def options_in_help(command):
    """Names of options, as the help lists them in its left column."""
    text = output_of(RAYCONE, *command, "--help")
    lists = re.findall(r"^  (-[-\w,]+)(?: |$)", text, re.M)
    return {name for names in lists for name in names.split(",")}


def commands_in_help():
    text = output_of(RAYCONE, "--help")
    return re.findall(r"^  (\w+) ", text[text.index("Commands:") : text.index("Examples:")], re.M)


COMMANDS = commands_in_help()


class ManualPage(unittest.TestCase):
    def test_lists_the_options_of_each_command(self):
        page = re.sub("\x1b\\[[0-9]*m|.\b", "", output_of("mandoc", "-Tascii", "-Owidth=200", MAN))
        sections = {}
        for line in page.splitlines()[1:]:
            if re.match(r"[A-Z]", line):
                lines = sections.setdefault(line.lower(), [])
            elif sections:
                lines.append(line.strip())
        for command in COMMANDS:
            tags = [line.split("  ")[0] for line in sections["raycone " + command] if re.match(r"--?[a-z0]", line)]
            listed = {name.split()[0] for tag in tags for name in tag.split(", ")}
            self.assertEqual(listed, options_in_help([command]), command)
            self.assertIn("raycone " + command, " ".join(sections["synopsis"]))
        self.assertIn("0 done, 1 usage", " ".join(sections["exit status"]))

    def test_is_sound(self):
        self.assertEqual(output_of("mandoc", "-Tlint", "-Wwarning", MAN), "")
        if shutil.which("man"):
            output_of("man", "--warnings", "-l", MAN, env={**PLAIN, "MANPAGER": "cat"})


def complete_in_bash(*words):
    """What bash offers for the last of `words`, and the options that the function sets for readline."""
    script = r"""source "$1"; shift
        compopt() { set_options+=("${@: -1}"); }
        COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _raycone
        printf '%s\n' "${COMPREPLY[@]}"; echo; printf '%s\n' "${set_options[@]}" """
    offered, set_options = output_of("bash", "-uc", script, "bash", BASH, *words, env=PLAIN).split("\n\n", 1)
    return set(offered.split()), set(set_options.split())


class BashCompletion(unittest.TestCase):
    def offers(self, words, *expected):
        self.assertEqual(complete_in_bash("raycone", *words)[0], set(expected), words)

    def asks_readline_for(self, words, *expected):
        self.assertEqual(complete_in_bash("raycone", *words), (set(), set(expected)), words)

    def test_offers_commands_first(self):
        self.offers([""], *COMMANDS)
        self.offers(["lat"], "lattice")
        self.offers(["--quiet", "--threads", "2", "sl"], "slice")
        self.offers(["-"], "-h", "--help", "-V", "--version")
        self.offers(["help", "sl"], "slice")

    def test_offers_the_options_of_each_command(self):
        for command in COMMANDS:
            self.offers([command, "-"], *options_in_help([command]))
        self.offers(["points", "--threads", "2", "a.obj", "--co"], "--columns")
        self.offers(["lattice", "--no-such"])

    def test_offers_the_values_of_an_option(self):
        self.offers(["lattice", "--weld", ""], "exact", "none")
        self.offers(["lattice", "--weld", "=", "e"], "exact")  # as readline splits --weld=e
        self.offers(["lattice", "--weld", "="], "exact", "none")
        self.offers(["lattice", "--format", ""], "vdb", "csv", "npy", "npz", "vti", "nrrd", "nii", "nii.gz")
        self.offers(["slice", "--format", ""], "png")
        self.offers(["slice", "--axis", ""], "x", "y", "z")
        self.offers(["batch", "--shard", "s"], "slurm")
        self.offers(["batch", "--format", "n"], "npy", "none", "npz", "nrrd", "nii", "nii.gz")
        self.offers(["lattice", "--engine", "em"], "embree")

    def test_takes_files_words_and_numbers_from_the_placeholder(self):
        for command in COMMANDS:
            text = output_of(RAYCONE, command, "--help")
            for option, placeholder in re.findall(r"^  (?:-\w,)?(--[-\w]+) (\S+)", text, re.M):
                offered, asked = complete_in_bash("raycone", command, option, "")
                words = {word for word in placeholder.replace("[,...]", "").split("|") if word[0].islower()}
                self.assertEqual(offered, {re.sub("=.*", "=", word) for word in words}, (command, option))
                files = {"default"} if re.match(r"OUT|[A-Z]+\.[a-z]+", placeholder) else set()
                self.assertEqual(asked - {"nospace"}, {"dirnames"} if placeholder == "DIR" else files, (command, option))

    def test_goes_on_behind_commas_and_equals_signs(self):
        self.offers(["lattice", "--field", "winding,s"], "winding,sdf", "winding,solid")
        self.assertEqual(complete_in_bash("raycone", "lattice", "--rule", "thr"), ({"threshold="}, {"nospace"}))
        self.asks_readline_for(["lattice", "--rule", "threshold", "=", "0."])

    def test_leaves_files_to_readline(self):
        self.asks_readline_for(["lattice", ""], "default")
        self.asks_readline_for(["lattice", "a.obj", "-o", ""], "default")
        self.asks_readline_for(["lattice", "a.obj", "--report", "=", "x"], "default")
        self.asks_readline_for(["slice", "a.obj", "--values", ""], "default")
        self.asks_readline_for(["batch", "meshes", "--out-dir", ""], "dirnames")
        self.asks_readline_for(["report", ""], "dirnames")
        self.asks_readline_for(["lattice", "--", "-"], "default")

    def test_offers_nothing_where_only_the_user_knows(self):
        self.asks_readline_for(["lattice", "--scale", ""])
        self.asks_readline_for(["lattice", "--bounds", "-1"])


class ZshCompletion(unittest.TestCase):
    def test_knows_the_options_of_each_command(self):
        with open(ZSH) as file:
            cases = dict(re.findall(r"^ +(\w+)\)\n +_arguments (.*?);;", file.read(), re.M | re.S))
        self.assertEqual(list(cases), COMMANDS)
        for command in COMMANDS:
            names = re.findall(r"'\([^)]*\)(-[-\w]+)[=+]?\[", cases[command])
            self.assertEqual(set(names), options_in_help([command]), command)


class Terminal:
    """An interactive shell that is typed into."""

    def __init__(self, directory, *command):
        self.process, self.terminal = pty.fork()
        if self.process == 0:
            os.chdir(directory)
            os.environ.update(PS1="$ ", HOME=directory, ZDOTDIR=directory, TERM="dumb", INPUTRC="/dev/null")
            os.execvp(command[0], command)

    def type_until(self, keys, expected, patience=120):
        """What appears once `keys` are typed, up to `expected`."""
        os.write(self.terminal, keys.encode())
        shown, end = "", time.monotonic() + patience
        while expected not in shown:
            if not select.select([self.terminal], [], [], max(0, end - time.monotonic()))[0]:
                raise AssertionError("typed %r, expected %r, but saw %r" % (keys, expected, shown))
            shown += os.read(self.terminal, 4096).decode(errors="replace")
        return shown

    def __enter__(self):
        return self

    # Not by a hangup, at which bash writes its history.
    def __exit__(self, *ignored):
        os.kill(self.process, signal.SIGKILL)
        os.waitpid(self.process, 0)
        os.close(self.terminal)


class RealShells(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name
        os.mkdir(self.directory + "/fields")
        open(self.directory + "/my mesh.obj", "w").close()

    def completes(self, shell):
        for typed, completed in [
            ("lat\t", "tice "),
            ("lattice --resol\t", "ution"),
            ("lattice --weld ex\t", "act "),
            ("lattice --progress=nev\t", "er"),
            ("lattice x --report=my\t", "\\ mesh.obj"),
            ("lattice --field winding,de\t", "nsity"),
            ("lattice --rule thr\t", "eshold="),
            ("lattice my\t", "\\ mesh.obj"),
            ("lattice x -o my\t", "\\ mesh.obj"),
            ("batch x --out-dir f\t", "ields/"),
            ("report f\t", "ields/"),
        ]:
            shell.type_until("\x15raycone " + typed, completed)

    def test_bash(self):
        with Terminal(self.directory, "bash", "--norc", "--noprofile", "-i") as shell:
            shell.type_until("bind 'set enable-bracketed-paste off'; source '%s'; echo rea''dy\n" % BASH, "ready")
            self.completes(shell)

    def test_zsh(self):
        with Terminal(self.directory, "zsh", "-f", "-i") as shell:
            start = "fpath=('%s' $fpath); autoload -Uz compinit; compinit -D -u; echo rea''dy\n" % DIRECTORY
            shell.type_until(start, "ready")
            self.completes(shell)


if __name__ == "__main__":
    unittest.main()
