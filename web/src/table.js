// Tables of numbers: grouped heads, tabular figures, the raw value kept on each cell for tests and CSV.
import { button, element } from "./dom.js";
import { save_csv } from "./export.js";
import { number_text } from "./format.js";

let numbered = 0;

/**
 * @param columns  [{key, title, unit?, group?, text?: (value, row) -> string or node, is_text?, of_class?}]; neighbours with
 *                 the same group share a head
 * @param rows     objects by key; numbers may be null
 * @param all_rows  for the file, where the page shows only some
 * @param is_stacked  on a phone each row of more than four columns is a block of its own
 */
export function data_table({ id, title, caption, columns, rows, all_rows = rows, is_stacked = true }) {
  numbered += 1;
  const csv = button("CSV", "Save this table as CSV", () => save_csv(id, csv_rows(columns, all_rows)), {
    "data-export": "csv",
  });
  return element(
    "div",
    { class: "table-block", id: `table-${id}` },
    element(
      "div",
      { class: "plot-head" },
      element("div", { class: "plot-title" }, element("b", {}, `Table ${numbered}`), ` ${title}`),
      element("div", { class: "tools" }, csv),
    ),
    element(
      "div",
      { class: "table-scroll", tabindex: "0", role: "region", "aria-label": title },
      element(
        "table",
        { "data-table": id, class: columns.length <= 4 ? "compact" : is_stacked ? "stack" : null },
        heads(columns),
        element(
          "tbody",
          {},
          rows.map((row) =>
            element(
              "tr",
              { "data-row": row.name ?? null },
              columns.map((column, position) => cell(column, row, position === 0)),
            ),
          ),
        ),
      ),
    ),
    caption ? element("p", { class: "note" }, caption) : null,
  );
}

function cell(column, row, is_head) {
  const value = row[column.key];
  const shown = column.text ? column.text(value, row) : column.is_text ? (value ?? "–") : number_text(value);
  const attributes = {
    class: [column.is_text ? null : "number", column.of_class?.(row)].filter(Boolean).join(" ") || null,
    "data-key": column.key,
    "data-label": `${column.group ? `${column.group}: ` : ""}${column.title}${column.unit ? ` ${column.unit}` : ""}`, // on a phone a row is a block of its own
    "data-value": typeof value === "number" ? value : null,
  };
  return is_head ? element("th", { ...attributes, scope: "row" }, shown) : element("td", attributes, shown);
}

function heads(columns) {
  const title = (column) => [column.title, column.unit ? element("span", { class: "unit" }, ` ${column.unit}`) : null];
  const number_class = (column) => (column.is_text ? null : "number");
  if (!columns.some((column) => column.group)) {
    return element(
      "thead",
      {},
      element(
        "tr",
        {},
        columns.map((column) => element("th", { scope: "col", class: number_class(column) }, title(column))),
      ),
    );
  }
  const upper = [];
  const lower = [];
  for (let i = 0; i < columns.length;) {
    const { group } = columns[i];
    if (!group) {
      upper.push(element("th", { scope: "col", rowspan: 2, class: number_class(columns[i]) }, title(columns[i])));
      i += 1;
      continue;
    }
    let end = i;
    while (end < columns.length && columns[end].group === group) end += 1;
    upper.push(element("th", { scope: "colgroup", colspan: end - i, class: "group" }, group));
    for (const column of columns.slice(i, end)) {
      lower.push(element("th", { scope: "col", class: number_class(column) }, title(column)));
    }
    i = end;
  }
  return element("thead", {}, element("tr", {}, upper), element("tr", {}, lower));
}

function csv_rows(columns, rows) {
  const head = columns.map(({ group, title, unit }) => [group, title, unit].filter(Boolean).join(" "));
  return [head, ...rows.map((row) => columns.map(({ key, csv }) => (csv ? csv(row) : row[key])))];
}
