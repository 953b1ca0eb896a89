// Files from the page: a plot as PNG or SVG, a table as CSV.
import { create_copy } from "./charts.js";

const exported_width = 1000;

function save(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

export function save_svg(id) {
  const copy = create_copy(id, null, { renderer: "svg", width: exported_width });
  save(`mottle-${id}.svg`, new Blob([copy.renderToSVGString()], { type: "image/svg+xml" }));
  copy.dispose();
}

export function save_png(id) {
  const copy = create_copy(id, document.createElement("div"), { renderer: "canvas", width: exported_width });
  save_canvas(id, copy.renderToCanvas({ pixelRatio: 2, backgroundColor: "#ffffff" }), () => copy.dispose());
}

export function save_canvas(id, canvas, and_then = () => {}) {
  canvas.toBlob((blob) => {
    save(`mottle-${id}.png`, blob);
    and_then();
  }, "image/png");
}

/** Quoted where needed; a leading = + - @ of a text is defused, as spreadsheets would run it. */
function csv_field(value) {
  if (value === null || value === undefined) return "";
  if (typeof value === "number") return String(value);
  const text = /^[=+\-@]/.test(value) ? `'${value}` : String(value);
  return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

export function save_csv(id, rows) {
  const text = rows.map((row) => row.map(csv_field).join(",")).join("\r\n");
  save(`mottle-${id}.csv`, new Blob([`${text}\r\n`], { type: "text/csv" }));
}
