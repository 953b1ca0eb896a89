// Writes a file's bytes as a C++ source: string literals compile in a fraction of the time of an array of numbers.
//   node embed.mjs page.html mottle_page.cpp
import { readFileSync, writeFileSync } from "node:fs";

const [input, output] = process.argv.slice(2);
const bytes = readFileSync(input);
const literal_bytes = 12000; // keeps the lines readable; the compiler joins the literals

/** Three octal digits where a byte is not plain ASCII, so that no digit after it can be taken as part of it. */
function escape(byte) {
  if (byte === 0x22 || byte === 0x5c || byte === 0x3f) return "\\" + String.fromCharCode(byte); // " \ and ?, of trigraphs
  if (byte === 0x0a) return "\\n";
  if (byte < 0x20 || byte > 0x7e) return "\\" + byte.toString(8).padStart(3, "0");
  return String.fromCharCode(byte);
}

const literals = [];
for (let start = 0; start < bytes.length; start += literal_bytes) {
  literals.push('    "' + Array.from(bytes.subarray(start, start + literal_bytes), escape).join("") + '"');
}
writeFileSync(
  output,
  `// Made by web/embed.mjs; do not edit.
#include "mottle_page.hpp"

namespace mottle::detail {

std::string_view mottle_page_template() {
  static constexpr char k_page[] =
${literals.join("\n")};
  return {k_page, sizeof(k_page) - 1};
}

}  // namespace mottle::detail
`,
);
