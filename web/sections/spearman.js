// Rank correlation of every parameter with every output over the first cloud, as a map with its numbers.
import { is_number, list } from "../src/data.js";
import { figure } from "../src/figure.js";
import { matrix_map, signed } from "../src/matrix_map.js";
import { diverging } from "../src/palette.js";

const cell = {
  width_at_most: 130,
  height_at_least: 22,
  height_at_most: 38,
  aspect: 0.6,
  name_at_most: 150,
  column_room: 60,
};

export default {
  id: "spearman",
  title: "Rank correlation of parameters and outputs",
  has_data: (study) => list(study.result.spearman).some((row) => list(row).some(is_number)),
  explained: [
    [
      "Spearman map",
      "Rank correlation over the first cloud: +1 both increase together, −1 one decreases as the other increases, 0 no monotone relation. " +
        "A parameter with a pale row cannot be identified from these outputs.",
    ],
  ],
  content(study) {
    return [
      figure({
        id: "spearman",
        title: "Spearman's rank correlation of parameters and outputs",
        caption: "Rows are parameters, columns are outputs; first cloud.",
        build: matrix_map({
          name: "Spearman's rank correlation",
          rows: study.parameter_axes.map(({ name }) => name),
          columns: study.output_axes.map(({ name }) => name),
          values: list(study.result.spearman),
          low: -1,
          high: 1,
          ends: ["+1", "\u22121"],
          stops: () => diverging,
          is_deep: (rho) => Math.abs(rho) > 0.78,
          cell,
          tooltip: (row, column, rho) => [`${row} → ${column}`, `Spearman's ρ: ${signed(rho)}`],
        }),
      }),
    ];
  },
};
