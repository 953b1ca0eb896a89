// Bundles the page's modules, styles and markup into one HTML file that needs no network.
//   node build.mjs [--source DIR] [--out FILE]      defaults: this folder, dist/page.html in it
// Libraries come from node_modules beside this file, so a copy of it elsewhere can build the sources in place.
import { createHash } from "node:crypto";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { build } from "esbuild";

const here = path.dirname(fileURLToPath(import.meta.url));
const { values } = parseArgs({ options: { source: { type: "string" }, out: { type: "string" } } });
const source = path.resolve(values.source ?? here);
const out = path.resolve(values.out ?? path.join(here, "dist", "page.html"));

// three.js is taken from its sources, without the shaders of its own materials: the page brings the only shaders that it uses.
// That saves a third of what three.js adds to every report.
const lean_three = {
  name: "lean-three",
  setup(bundler) {
    const index = path.join(here, "node_modules", "three", "src", "Three.js");
    bundler.onResolve({ filter: /^three$/ }, () => ({ path: index, sideEffects: false }));
    bundler.onLoad(
      { filter: /three[\\/]src[\\/]renderers[\\/]shaders[\\/]Shader(Chunk|Lib)[\\/].*\.glsl\.js$/ },
      () => ({
        contents: 'export default ""; export const vertex = "", fragment = "";',
      }),
    );
  },
};

async function bundle(entry) {
  const result = await build({
    entryPoints: [path.join(source, entry)],
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    target: ["chrome100", "firefox100", "safari15"],
    charset: "utf8",
    legalComments: "none",
    nodePaths: [path.join(here, "node_modules")],
    plugins: [lean_three],
    define: { "process.env.NODE_ENV": '"production"' },
    logLevel: "warning",
  });
  return result.outputFiles[0].text.trim();
}

/** Replaces the one occurrence of `mark`; a function as replacement keeps `$&` in a bundle literal. */
function replace_once(text, mark, replacement) {
  if (text.split(mark).length !== 2) throw new Error(`${mark} must occur exactly once`);
  return text.replace(mark, () => replacement);
}

/** The browser refuses every script but this one, every eval and every address but data: and blob: images. */
function policy(script) {
  const hash = createHash("sha256").update(script, "utf8").digest("base64");
  return (
    `default-src 'none'; script-src 'sha256-${hash}'; style-src 'unsafe-inline'; img-src data: blob:; ` +
    "base-uri 'none'; form-action 'none'"
  );
}

/** The bundled libraries' licences, as they ask, in a comment at the end of the page. */
async function licences() {
  const files = ["echarts/NOTICE", "echarts/LICENSE", "zrender/LICENSE", "tslib/LICENSE.txt", "three/LICENSE"];
  const texts = await Promise.all(
    files.map(
      async (file) =>
        `${file}\n${"-".repeat(file.length)}\n${await readFile(path.join(here, "node_modules", file), "utf8")}`,
    ),
  );
  return `<!--\nLibraries in this page and their licences.\n\n${texts.join("\n\n").replaceAll("--", "- -")}\n-->`;
}

const [markup, style, script] = await Promise.all([
  readFile(path.join(source, "page.html"), "utf8"),
  bundle("style.css"),
  bundle("page.js"),
]);
for (const [what, text, breaker] of [
  ["script", script, /<\/script|<!--/i],
  ["style", style, /<\/style/i],
]) {
  if (breaker.test(text)) throw new Error(`the ${what} holds ${breaker}, which would end it inside a page`);
}

let page = replace_once(markup, "/*MOTTLE_POLICY*/", policy(script));
page = replace_once(page, "/*MOTTLE_STYLE*/", style);
page = replace_once(page, "/*MOTTLE_SCRIPT*/", script);
page = replace_once(page, "<!--MOTTLE_LICENCES-->", await licences());
if (page.split("/*MOTTLE_DATA*/").length !== 2) throw new Error("the page must hold exactly one place for the data");

await mkdir(path.dirname(out), { recursive: true });
await writeFile(out, page);
console.log(`${out}: ${(Buffer.byteLength(page) / 1024).toFixed(0)} kB`);
