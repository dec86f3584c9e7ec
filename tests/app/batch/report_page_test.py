"""The report page in a browser: python3 report_page_test.py RAYCONE MESH_DIRECTORY [--screenshot FILE.png].

Debian's chromium, headless, opens the page without a word on its console. The buttons and the address filter the rows
by their warnings; headings sort them. Skips (77) where there is no chromium.
"""

import argparse
import csv
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

parser = argparse.ArgumentParser()
parser.add_argument("raycone")
parser.add_argument("meshes")
parser.add_argument("--screenshot")
given = parser.parse_args()
RAYCONE, MESHES = os.path.abspath(given.raycone), os.path.abspath(given.meshes)
CHROMIUM = shutil.which("chromium")
if not CHROMIUM:
    print("skipped: no chromium")
    sys.exit(77)

WARNINGS = {"cube.obj": "reversed", "open_box.obj": "inconsistent reversed", "a,<b>\n'\".obj": "empty", "torn.obj": ""}
ALL = sorted(WARNINGS)

# Clicks as a user does, and leaves what is seen behind in the page. A change of the address is told of later.
SCRIPT = """
<script>
{
const seen = {}, buttons = [...document.querySelectorAll('.filter button')];
const names = () => [...document.querySelectorAll('tr[data-w]')].filter(row => row.checkVisibility())
  .map(row => row.querySelector('.name').textContent).sort();
const order = () => [...document.querySelectorAll('table')].at(-1).tBodies[0].textContent.match(/(cube|open_box|b>)/g);
const settled = () => new Promise(resolve => setTimeout(resolve, 50));
(async () => {
  seen.labels = buttons.map(button => button.textContent);
  seen.opened = names();
  for (const button of buttons) {
    button.click();
    await settled();
    const pressed = document.querySelectorAll('[aria-pressed=true]');
    seen[button.dataset.f] = [names(), pressed.length === 1 && pressed[0] === button];
  }
  for (const fragment of ['#warning=%', '#warning=constructor', '#']) {
    location.hash = fragment;
    await settled();
    seen[fragment] = names();
  }
  const heads = [...document.querySelectorAll('th.sort')].filter(head => head.textContent === 'faces');
  heads[0].click();
  seen.downwards = order();
  heads[0].click();
  seen.upwards = order();
  const result = document.createElement('pre');
  result.id = 'seen';
  result.textContent = JSON.stringify(seen);
  document.body.append(result);
})();
}
</script>
"""

failures = []


def check(what, is_good, found=""):
    if not is_good:
        failures.append("%s: %s" % (what, found))


def make_page(directory):
    os.mkdir(os.path.join(directory, "in"))
    for name in WARNINGS:
        source = name if os.path.exists(os.path.join(MESHES, name)) else "teapot.obj"
        with open(os.path.join(MESHES, source), "rb") as file:
            text = file.read()
        with open(os.path.join(directory, "in", name), "wb") as file:
            file.write(text[:500] if name == "torn.obj" else text)
    command = [RAYCONE, "batch", os.path.join(directory, "in"), "--out-dir", directory, "--resolution", "16", "--quiet"]
    check("batch", subprocess.run(command, stderr=subprocess.DEVNULL).returncode == 5)
    results = os.path.join(directory, "results.csv")
    with open(results, newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:  # which meshes raycone warns of is not the matter of this test
        row["warnings"] = WARNINGS[row["mesh"]]
    with open(results, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    subprocess.run([RAYCONE, "report", directory], check=True, stderr=subprocess.DEVNULL)
    with open(os.path.join(directory, "report.html")) as file:
        return file.read()


# The page as it is in the end. What scripts complain of goes to standard error, as CONSOLE.
def opened(directory, page, *options, fragment=""):
    path = os.path.join(directory, "page.html")
    with open(path, "w") as file:
        file.write(page)
    command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--enable-logging=stderr",
               "--virtual-time-budget=3000", "--user-data-dir=" + os.path.join(directory, "profile"), *options,
               "file://" + path + fragment]
    result = subprocess.run(command, capture_output=True, text=True, timeout=120)
    console = [line for line in result.stderr.splitlines() if "CONSOLE" in line]
    check("console", not console, console)
    return result.stdout


def main():
    with tempfile.TemporaryDirectory() as directory:
        page = make_page(directory)
        check("one body", page.count("</body>") == 1)
        dom = opened(directory, page.replace("</body>", SCRIPT + "</body>"), "--dump-dom", fragment="#warning=empty")
        match = re.search(r'<pre id="seen">(.*?)</pre>', dom, re.DOTALL)
        check("script", match is not None, dom[-500:])
        seen = json.loads(match[1].replace("&amp;", "&").replace("&lt;", "<").replace("&gt;", ">")) if match else {}
        expected = {
            "labels": ["all meshes 4", "empty 1", "inconsistent 1", "reversed 2", "none 1"],
            "": [4, True],
            "reversed": [["cube.obj", "open_box.obj"], True],
            "inconsistent": [["open_box.obj"], True],
            "none": [["torn.obj"], True],
            "downwards": ["b>", "cube", "open_box"],
            "upwards": ["open_box", "cube", "b>"],
        }
        for key, value in expected.items():
            found = seen.get(key)
            if key == "":
                found = [len(found[0]), found[1]] if found else found
            check(key, found == value, found)
        check("opened by its address", len(seen.get("opened", [])) == 1 and seen["opened"][0].startswith("a,<b>"),
              seen.get("opened"))
        for fragment in ("#warning=%", "#warning=constructor", "#"):
            check(fragment, len(seen.get(fragment, [])) == 4, seen.get(fragment))
        if given.screenshot:
            opened(directory, page, "--screenshot=" + os.path.abspath(given.screenshot), "--window-size=1300,1900")
    for failure in failures:
        print("FAILED", failure)
    print("%d failures" % len(failures))
    return 1 if failures else 0


sys.exit(main())
