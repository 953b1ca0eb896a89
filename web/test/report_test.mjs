// Opens a report from disk as a reader would and checks that it is complete, right and still.
//   node test/report_test.mjs PAGE.html [--screenshots DIR]
// Works on any page the program writes: what to expect is read from the data inside the page. Ends with
// "N passed, N failed" and a status other than zero on failure.
import { mkdirSync, readFileSync } from "node:fs";
import path from "node:path";
import { parseArgs } from "node:util";
import { in_readable_units } from "../src/units.js";
import { open_page } from "./browser.mjs";
import { checks } from "./checks.mjs";
import { population_checks } from "./population_checks.mjs";
import { posterior_checks } from "./posterior_checks.mjs";
import { first_screen_checks } from "./first_screen_checks.mjs";
import { has_scene, scene_checks } from "./scene_checks.mjs";

const { values, positionals } = parseArgs({ allowPositionals: true, options: { screenshots: { type: "string" } } });
if (positionals.length !== 1) {
  console.error("usage: node test/report_test.mjs PAGE.html [--screenshots DIR]");
  process.exit(2);
}
const file = positionals[0];
const name = path.basename(file, ".html");
if (values.screenshots) mkdirSync(values.screenshots, { recursive: true });

function data_of(html) {
  const start = html.indexOf('id="mottle-data">') + 'id="mottle-data">'.length;
  return JSON.parse(html.slice(start, html.indexOf("</script", start)));
}

const data = in_readable_units(data_of(readFileSync(file, "utf8"))); // as the page shows them
const opened = await open_page(file, { graphics: has_scene(data) ? "webgl" : "plain" });
const shot = async (what) => {
  if (values.screenshots)
    await opened.page.screenshot({ path: path.join(values.screenshots, `${name}-${what}.png`), fullPage: true });
};
let passed = 0;
let failed = 0;
try {
  const study = { ...opened, file, data, shot };
  for (const [claim, check] of [...(has_scene(data) ? scene_checks : []), ...first_screen_checks, ...population_checks, ...posterior_checks, ...checks]) {
    try {
      await check(study);
      passed += 1;
      console.log(`ok    ${claim}`);
    } catch (error) {
      failed += 1;
      console.log(`FAIL  ${claim}\n      ${String(error.message).split("\n").slice(0, 6).join("\n      ")}`);
    }
  }
} finally {
  await opened.close();
}
console.log(`${passed} passed, ${failed} failed`);
process.exit(failed ? 1 : 0);
