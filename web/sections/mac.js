// The modal assurance criterion of two sets of shapes as a map: which mode of the one is which of the other.
import { is_number, list } from "../src/data.js";
import { figure } from "../src/figure.js";
import { mac_map } from "../src/mac_map.js";
import { signed } from "../src/matrix_map.js";

const cell = {
  width_at_most: 74,
  height_at_least: 13,
  height_at_most: 40,
  aspect: 0.62,
  name_at_most: 170,
  column_room: 84,
};

const title_of = (title, fallback) => String(title ?? "").trim() || fallback;

/** Names filled up where the data name fewer than they hold. */
function names_of(names, count) {
  return Array.from({ length: Math.max(list(names).length, count) }, (_, i) => String(list(names)[i] ?? i + 1));
}

export default {
  id: "mac",
  title: "Modal assurance criterion (MAC)",
  has_data: ({ mac }) => list(mac.values).some((row) => list(row).some(is_number)),
  explained: [
    [
      "MAC",
      "Modal assurance criterion of two shapes, their squared cosine: 1 the same shape, whatever its scale; 0 nothing in common. " +
        "A pair well above 0.8 is usually the same mode.",
    ],
  ],
  content({ mac }) {
    const values = list(mac.values);
    const row_title = title_of(mac.row_title, "rows");
    const column_title = title_of(mac.column_title, "columns");
    return [
      figure({
        id: "mac",
        title: `MAC of ${row_title} and ${column_title}`,
        caption: `Rows: shapes of ${row_title}; columns: shapes of ${column_title}.`,
        build: mac_map({
          rows: names_of(mac.rows, values.length),
          columns: names_of(mac.columns, Math.max(...values.map((row) => list(row).length))),
          values,
          cell,
          row_title,
          column_title,
          tooltip: (row, column, value) => [`${row} – ${column}`, `MAC: ${signed(value)}`],
        }),
      }),
    ];
  },
};
