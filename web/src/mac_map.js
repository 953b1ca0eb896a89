// A map of the modal assurance criterion: dark where two shapes are the same.
import { colour_at, is_deep } from "./colour_scale.js";
import { matrix_map } from "./matrix_map.js";
import { sequential } from "./palette.js";

const fixed = {
  name: "MAC",
  low: 0,
  high: 1,
  ends: ["1", "0"],
  stops: () => sequential,
  is_deep: (value) => is_deep(colour_at(sequential, value)),
};

/** What `matrix_map` makes of rows, columns, values, cell, titles and tooltip of a MAC matrix. */
export const mac_map = (matrix) => matrix_map({ ...fixed, ...matrix });
