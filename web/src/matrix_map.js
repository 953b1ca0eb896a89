// A matrix of numbers as a map of coloured cells with their values: the map of the rank correlations and that of the MAC.
import { is_number, list } from "./data.js";
import { axis, tooltip_box } from "./charts.js";
import { fit_in } from "./format.js";
import { ink, on_deep, on_pale, paper } from "./palette.js";

export const signed = (value) => `${value <= -0.005 ? "\u2212" : ""}${Math.abs(value).toFixed(2)}`;

/** [column, row, value within the scale, value] of every cell that has one. */
function cells_of({ values, rows, columns, low, high }) {
  return rows
    .flatMap((_, row) => columns.map((__, column) => [column, row, list(values[row])[column]]))
    .filter(([, , value]) => is_number(value))
    .map(([column, row, value]) => [column, row, Math.min(high, Math.max(low, value)), value]);
}

/** The cells as ECharts takes them; framed ones at the end, so that no neighbour is drawn over a frame. */
function framed_last(map, frame) {
  const { is_deep, is_marked = () => false } = map;
  const cells = cells_of(map).map((value) => ({
    value,
    label: { color: is_deep(value[2]) ? on_deep : on_pale },
    is_framed: is_marked(value[1], value[0], value[3]),
  }));
  return [
    ...cells.filter(({ is_framed }) => !is_framed),
    ...cells.filter(({ is_framed }) => is_framed).map((cell) => ({ ...cell, itemStyle: frame })),
  ];
}

/** Where the cells lie: as wide as the page allows up to a limit, the names of the rows on the left. */
function layout_of({ rows, columns, cell, left_gap = 0 }, width) {
  const name_width = Math.min(cell.name_at_most, 24 + 7 * Math.max(...rows.map((name) => name.length))) + left_gap;
  const inner_width = Math.min(width - name_width - 16, cell.width_at_most * columns.length);
  const cell_width = inner_width / columns.length;
  const cell_height = Math.min(cell.height_at_most, Math.max(cell.height_at_least, cell_width * cell.aspect));
  return { name_width, inner_width, cell_width, cell_height };
}

/**
 * @param name           of the series, for readers of the drawing's data
 * @param rows, columns  their names
 * @param values         [row][column], null where there is none
 * @param low, high      the ends of the scale; `ends` their texts, high first
 * @param stops          colours of the scale
 * @param is_marked      (row index, column index, value) -> whether the cell is framed, optional
 * @param is_deep        (value) -> whether its colour is so deep that it takes white text
 * @param cell           {width_at_most, height_at_least, height_at_most, aspect (height over width), name_at_most,
 *                       column_room (for turned names of columns)}
 * @param row_title, column_title  of the axes, optional
 * @param tooltip        (row, column, value) -> [heading, line, ...]
 * @return               (width) -> {option, height}
 */
export function matrix_map(map) {
  const { name, rows, columns, low, high, ends, stops, row_title = "", column_title = "", tooltip } = map;
  return (width) => {
    const { name_width, inner_width, cell_width, cell_height } = layout_of(
      { ...map, left_gap: row_title ? 18 : 0 },
      width,
    );
    const grid = {
      left: name_width,
      top: 10,
      width: inner_width,
      height: Math.round(rows.length * cell_height),
      outerBoundsMode: "none",
    };
    const label_size = Math.min(12, Math.max(8, cell_width / 4));
    const label_width = name_width - 12 - (row_title ? 18 : 0);
    const turned =
      cell_width < 44
        ? { rotate: 60, formatter: fit_in(map.cell.column_room) }
        : { formatter: fit_in(cell_width - 16) };
    const under = turned.rotate ? map.cell.column_room : 34;
    const category = (names, more) =>
      axis({
        type: "category",
        data: names,
        splitLine: { show: false },
        axisTick: { show: false },
        axisLine: { show: false },
        axisLabel: {
          color: ink,
          fontSize: 12,
          interval: cell_width < 13 ? Math.ceil(13 / cell_width) - 1 : 0,
          ...turned,
        },
        ...more,
      });
    const option = {
      grid: [grid],
      xAxis: category(columns, { name: column_title, nameGap: under - 6 }),
      yAxis: category(rows, {
        inverse: true,
        name: row_title,
        nameGap: name_width - 14,
        axisLabel: {
          color: ink,
          fontSize: Math.min(12, Math.max(8, cell_height - 3)),
          interval: 0,
          formatter: fit_in(label_width, Math.min(12, Math.max(8, cell_height - 3))),
        },
      }),
      visualMap: {
        type: "continuous",
        min: low,
        max: high,
        precision: 1,
        dimension: 2,
        orient: "horizontal",
        left: name_width - 6,
        bottom: 0,
        itemWidth: 12,
        itemHeight: Math.min(220, Math.max(120, inner_width - 80)),
        text: ends,
        textStyle: { color: ink, fontSize: 11 },
        calculable: false,
        inRange: { color: stops() },
      },
      tooltip: {
        trigger: "item",
        formatter: ({ value: [column, row, , value] }) => {
          const [heading, ...lines] = tooltip(rows[row], columns[column], value);
          return tooltip_box(heading, lines);
        },
      },
      series: [
        {
          name,
          type: "heatmap",
          itemStyle: { borderColor: paper, borderWidth: cell_width < 14 ? 0.5 : 1.5 },
          label: {
            show: cell_width >= 26 && cell_height >= 12,
            fontSize: label_size,
            color: on_pale,
            formatter: ({ value }) => signed(value[3]),
          },
          data: framed_last(map, { borderColor: ink, borderWidth: cell_width < 14 ? 1.5 : 2.5 }),
        },
      ],
    };
    return { option, height: grid.top + grid.height + under + (column_title ? 22 : 0) + 40 };
  };
}
