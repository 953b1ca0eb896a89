// Opens pages from disk as a reader would and checks that they are complete, right and still.
//   node test/report_test.mjs PAGE.html... [--results FOLDER]... [--screenshots DIR] [--laid-out-as-others NAME]... [--thorough]
// Works on any page the program writes: what to expect is read from the data inside the page, and for a page of `mottle compare`
// from the folders of the results. All pages are shown in one tab of one browser. A quick test does once what depends on a kind of plot
// and not on its data (zooming, saving, dark colours), in a small window; --thorough does everything on every page, in a large one,
// saves with the mouse only, and takes pictures of what is shown; without it, only of what fails. A quick test leaves out the layout
// of the pages that are named as laid out as others.
// Ends with "N passed, N failed" and a status other than zero on failure.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync } from "node:fs";
import path from "node:path";
import { parseArgs } from "node:util";
import { in_readable_units } from "../src/units.js";
import { answer_checks } from "./answer_checks.mjs";
import { open_browser, patience } from "./browser.mjs";
import { checks } from "./checks.mjs";
import { compare_checks } from "./compare_checks.mjs";
import { diagnosis_checks } from "./diagnosis_checks.mjs";
import { first_screen_checks } from "./first_screen_checks.mjs";
import { layout_checks } from "./layout_checks.mjs";
import { population_checks } from "./population_checks.mjs";
import { posterior_checks } from "./posterior_checks.mjs";
import { has_scene, scene_checks } from "./scene_checks.mjs";

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    results: { type: "string", multiple: true, default: [] },
    screenshots: { type: "string" },
    "laid-out-as-others": { type: "string", multiple: true, default: [] },
    thorough: { type: "boolean", default: false },
  },
});
if (!positionals.length) {
  console.error("usage: node test/report_test.mjs PAGE.html... [--results FOLDER]... [--screenshots DIR] [--thorough]");
  process.exit(2);
}
if (values.screenshots) mkdirSync(values.screenshots, { recursive: true });
const folders = values.results;
const results = folders.map((folder) => JSON.parse(readFileSync(path.join(folder, "result.json"), "utf8")));

function data_of(html) {
  const start = html.indexOf('id="mottle-data">') + 'id="mottle-data">'.length;
  return JSON.parse(html.slice(start, html.indexOf("</script", start)));
}

/** "modes" of .../modes.html, "update" of .../update/report.html. */
function name_of(file) {
  const name = path.basename(file, ".html");
  return name === "report" ? path.basename(path.dirname(path.resolve(file))) : name;
}

const last_checks = [
  [
    "the page raises no error, runs no script but its own and asks for nothing else",
    async ({ complaints }) => assert.deepEqual(complaints, []),
  ],
];

/** How a page is to be looked at: [window, checks]. */
function views_of(data, name) {
  if (data.kind === "compare") {
    return [
      [{ width: 1440, height: 1000 }, [...compare_checks, ...last_checks]],
      [{ width: 390, height: 844 }, [...compare_checks, ...last_checks]],
    ];
  }
  if (data.kind === "diagnosis") {
    return [
      [{ width: 1280, height: 900 }, [...diagnosis_checks, ...last_checks]],
      [{ width: 390, height: 844 }, [...diagnosis_checks, ...last_checks]],
    ];
  }
  // WebGL is drawn by the processor here: the fewer pixels, the better.
  const small = { width: has_scene(data) ? 480 : 800, height: 700 };
  const window = values.thorough ? { width: 1280, height: 900 } : small;
  const structure = has_scene(data) ? scene_checks : [];
  const contents = [...first_screen_checks, ...answer_checks, ...population_checks, ...posterior_checks, ...checks];
  const layout = values.thorough || !values["laid-out-as-others"].includes(name) ? layout_checks : [];
  return [[window, [...structure, ...contents, ...layout, ...last_checks]]];
}

const browsers = new Map();
/** Started when it is needed, and then kept. */
async function browser_of(graphics) {
  if (!browsers.has(graphics)) browsers.set(graphics, await open_browser(graphics));
  return browsers.get(graphics);
}

const done = new Set();
/** Whether to do what depends on a kind of plot, not on its data: a quick test does it on the first page that has the plot. */
function is_due(what) {
  const is_first = !done.has(what);
  done.add(what);
  return is_first || values.thorough;
}

let passed = 0;
const failures = [];

/** Some of the driver's commands wait without end where the browser hangs: the check that hangs is to be named. */
function within_patience(check) {
  let timer = null;
  const too_late = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Error(`not done after ${(2 * patience) / 1000} s`)), 2 * patience);
  });
  return Promise.race([check, too_late]).finally(() => clearTimeout(timer));
}

async function fulfils(page, name, claim, check) {
  try {
    await within_patience(check());
    passed += 1;
    console.log(`ok    ${claim}`);
    return true;
  } catch (error) {
    failures.push(`FAIL  ${name}: ${claim}\n      ${String(error.message).split("\n").slice(0, 6).join("\n      ")}`);
    console.log(failures.at(-1));
    if (values.screenshots)
      await page.screenshot({ path: path.join(values.screenshots, `${name}-failed-${failures.length}.png`) }).catch(() => {});
    return false;
  }
}

async function test_page(file) {
  const { page, complaints, open } = await browser_of("webgl");
  const raw = data_of(readFileSync(file, "utf8"));
  const is_as_it_is = raw.kind === "compare" || raw.kind === "diagnosis";
  const data = is_as_it_is ? raw : in_readable_units(raw); // as the page shows them
  const name = name_of(file);
  for (const [window, all] of views_of(data, name)) {
    console.log(`\n${name}, ${window.width} pixels wide`);
    const shot = async (what) => {
      if (!values.screenshots || !values.thorough) return;
      await page.evaluate(() => window.scrollTo(0, 0)); // what sticks to the window would lie over something else
      await page.screenshot({ path: path.join(values.screenshots, `${name}-${what}.png`), fullPage: true });
    };
    const study = {
      page,
      complaints,
      file,
      data,
      shot,
      browser_of,
      folders,
      results,
      is_due,
      is_thorough: values.thorough,
      window,
      open: (media) => open(file, { ...window, media }),
    };
    if (!(await fulfils(page, name, "the page opens", () => study.open({})))) continue;
    if (is_as_it_is) await shot(window.width);
    for (const [claim, check] of all) await fulfils(page, name, claim, () => check(study));
  }
}

try {
  for (const file of positionals) await test_page(file);
} finally {
  for (const { close } of browsers.values()) await close();
}
if (failures.length) console.log(`\n${failures.join("\n")}`);
console.log(`\n${passed} passed, ${failures.length} failed`);
process.exit(failures.length ? 1 : 0);
