// What the page of a batch has within it: how it looks, and how its tables are sorted and filtered.
#pragma once

namespace raycone {

inline constexpr const char* kReportStyle = R"(
:root { color-scheme: light dark; --ink: #1c2733; --quiet: #5d6b7a; --line: #d7dee6; --paper: #fff; --panel: #f5f7f9;
  --mark: #2563a8; --bad: #b3261e; }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e9ee; --quiet: #9aa7b4; --line: #37424d; --paper: #14191e;
  --panel: #1d242b; --mark: #6aa9ea; --bad: #f2867e; } }
body { font: 15px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); margin: 0 auto;
  padding: 1.5rem; max-width: 1320px; }
h1 { font-size: 1.6rem; margin: 0; overflow-wrap: anywhere; }
h2 { font-size: 1.15rem; margin: 2.2rem 0 .6rem; }
.quiet { color: var(--quiet); }
.tiles { display: flex; flex-wrap: wrap; gap: .7rem; margin: 1.2rem 0; }
.tile { background: var(--panel); border-radius: 6px; padding: .6rem 1rem; min-width: 6.5rem; }
.tile b { display: block; font-size: 1.35rem; font-variant-numeric: tabular-nums; }
.bad, .bad b { color: var(--bad); }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(290px, 1fr)); gap: 1rem; }
figure { margin: 0; }
svg { display: block; width: 100%; background: var(--panel); border-radius: 6px; }
svg text { font-size: 11px; fill: var(--quiet); }
svg .label { font-size: 12px; fill: var(--ink); }
svg .grid { stroke: var(--line); fill: none; }
svg circle { fill: var(--mark); fill-opacity: .55; }
svg rect { fill: var(--mark); fill-opacity: .75; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 13px; }
th, td { padding: .3rem .6rem; border-bottom: 1px solid var(--line); text-align: left; vertical-align: middle; }
th { position: sticky; top: 0; background: var(--paper); vertical-align: bottom; }
th.sort { cursor: pointer; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
td.n { white-space: nowrap; }
.name, .message { overflow-wrap: anywhere; min-width: 9rem; }
td .message { color: var(--quiet); }
code { overflow-wrap: anywhere; }
.filter { display: flex; flex-wrap: wrap; gap: .4rem; }
.filter button { font: inherit; font-size: 13px; color: inherit; background: var(--panel);
  border: 1px solid var(--line); border-radius: 1rem; padding: .15rem .7rem; cursor: pointer; }
.filter button[aria-pressed=true] { color: var(--paper); background: var(--mark); border-color: var(--mark); }
td img { display: block; width: 64px; height: 64px; object-fit: contain; image-rendering: pixelated; }
)";

// Sorts by the column whose heading is clicked, downwards first for numbers. Shows the rows with the warning that the
// address names behind #warning=, or that is clicked; all where it names none that there is. A table without rows to
// show is hidden, with its heading.
inline constexpr const char* kReportScript = R"(
for (const head of document.querySelectorAll('th.sort')) head.addEventListener('click', () => {
  const body = head.closest('table').tBodies[0], column = head.cellIndex, numeric = head.classList.contains('n');
  const up = head.dataset.up = head.dataset.up === undefined ? (numeric ? '' : '1') : head.dataset.up ? '' : '1';
  const text = cell => (cell.querySelector('.name') ?? cell).textContent;
  const key = row => { const c = row.cells[column]; return numeric ? Number(c.dataset.v ?? -1) : text(c); };
  const order = (a, b) => { const x = key(a), y = key(b); return (x < y ? -1 : x > y ? 1 : 0) * (up ? 1 : -1); };
  body.append(...[...body.rows].sort(order));
});
const buttons = [...document.querySelectorAll('.filter button')];
const fragment = button => '#warning=' + encodeURIComponent(button.dataset.f);
const filter = () => {
  const chosen = buttons.find(button => location.hash === fragment(button)) ?? buttons[0];
  for (const button of buttons) button.setAttribute('aria-pressed', button === chosen);
  const name = chosen?.dataset.f;
  for (const row of document.querySelectorAll('tr[data-w]'))
    row.hidden = Boolean(name) && !row.dataset.w.split(' ').includes(name);
  for (const section of document.querySelectorAll('section'))
    section.hidden = ![...section.querySelectorAll('tr[data-w]')].some(row => !row.hidden);
};
for (const button of buttons) button.addEventListener('click', () => { location.hash = fragment(button); });
addEventListener('hashchange', filter);
filter();
)";

}  // namespace raycone
