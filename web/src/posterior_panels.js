// Drawings of a sampled posterior: ranks of its chains, stages of its islands, their evidences.
import { extent, is_number } from "./data.js";
import { legend, legend_height, tooltip_box, zooming } from "./charts.js";
import { number_text, plural, short_number } from "./format.js";
import { band_series, layout, line_series, panel_frame } from "./panels.js";
import { band, model, paper, test, test_band } from "./palette.js";

const island_line = { color: model, width: 1.3, opacity: 0.6 };

/** One panel a name: how many of the draws of each chain lie in each of the equal parts of the ranks. */
export function rank_panels(posterior, names, width) {
  const { bins, range, counts } = posterior.ranks;
  const { cells, height } = layout(names.length, width, { aspect: 0.5, legend_height: 6 });
  const drawn = names.map((name) => counts[posterior.names.indexOf(name)] ?? []);
  const top = 1.1 * Math.max(...drawn.flat(2).filter(is_number), range[1] ?? 0);
  const panels = names.map((name) => ({
    title: name,
    x: {
      name: "Rank among the draws of all chains",
      min: 0,
      max: 1,
      axisLabel: { fontSize: 11, formatter: (value) => short_number(value, 2) },
    },
    y: { name: "Draws", min: 0, max: top, axisLabel: { fontSize: 11, showMaxLabel: false, formatter: (value) => short_number(value, 3) } },
  }));
  const series = drawn.flatMap((chains, panel) => [
    band_series("Expected of independent draws, 95 % of counts", [[0, ...range], [1, ...range]], test_band, panel),
    ...chains.map((row, chain) =>
      line_series(`Island ${chain + 1}`, row.map((count, k) => [(k + 0.5) / bins, count]), panel, island_line, {
        step: "middle",
        z: 3,
      }),
    ),
  ]);
  const option = {
    ...panel_frame(panels, cells),
    ...zooming(panels.length),
    series,
    tooltip: {
      trigger: "axis",
      formatter: (points) => {
        const lines = points.filter(({ seriesType }) => seriesType === "line");
        return lines.length
          ? tooltip_box(names[lines[0].axisIndex], lines.map(({ seriesName, value }) => `${seriesName}: ${plural(value[1], "draw")}`))
          : "";
      },
    },
  };
  return { option, height };
}

const stage_fields = [
  { field: "exponent", title: "Exponent of the likelihood", type: "log" },
  { field: "acceptance", title: "Accepted moves, fraction" },
  { field: "moves", title: "Moves of every particle" },
  { field: "correlation", title: "Correlation left with the stage's start" },
];

/** One panel for each thing that is known of a stage, a line an island. */
export function stage_panels({ stages }, width) {
  const { cells, height } = layout(stage_fields.length, width, { columns_at_most: 2, minimum: 320, aspect: 0.4, legend_height: 6 });
  const panels = stage_fields.map(({ title, type }) => ({
    title,
    x: { name: "Stage", minInterval: 1 },
    y: type ? { type, axisLabel: { fontSize: 11, formatter: (value) => number_text(value, 1) } } : { min: 0 },
  }));
  const series = stage_fields.flatMap(({ field, type }, panel) =>
    stages.map((chain, island) =>
      line_series(
        `Island ${island + 1}`,
        chain.map((stage, k) => [k + 1, stage[field]]).filter(([, value]) => is_number(value) && (!type || value > 0)),
        panel,
        island_line,
        { symbol: "circle", symbolSize: 3.5 },
      ),
    ),
  );
  const option = {
    ...panel_frame(panels, cells),
    ...zooming(panels.length),
    series,
    tooltip: {
      trigger: "axis",
      formatter: (points) =>
        tooltip_box(
          `${stage_fields[points[0].axisIndex].title}, stage ${points[0].value[0]}`,
          points.map(({ seriesName, value }) => `${seriesName}: ${number_text(value[1], 3)}`),
        ),
    },
  };
  return { option, height };
}

const evidence_names = (by_importance) => ({
  interval: "95 % interval",
  value: by_importance ? "By importance sampling" : "ln of the islands' mean evidence",
  islands: "Island",
});

/** ln evidence of each island, and what they say together. */
export function evidence_panel({ value, interval, islands, by_importance }, width) {
  const names = evidence_names(by_importance);
  const known = islands.map((x, k) => [x, k + 1]).filter(([x]) => is_number(x));
  const [low, high] = extent([...known.map(([x]) => x), value, ...(interval ?? [])]);
  const margin = 0.08 * (high - low) || 0.1;
  const rows = [0.3, islands.length + 0.7];
  const shown = Object.values(names);
  const { cells, height } = layout(1, Math.min(width, 760), { aspect: 0.32, legend_height: legend_height(shown, width) });
  const series = [
    interval ? band_series(names.interval, interval.map((x) => [x, ...rows]), band, 0) : null,
    line_series(names.value, rows.map((y) => [value, y]), 0, { color: model }, { z: 2, silent: true }),
    {
      name: names.islands,
      type: "scatter",
      symbol: "circle",
      symbolSize: 8,
      z: 3,
      itemStyle: { color: test, borderColor: paper, borderWidth: 0.8 },
      data: known,
    },
  ].filter(Boolean);
  const option = {
    ...panel_frame(
      [
        {
          title: "",
          x: {
            name: "ln evidence",
            min: low - margin,
            max: high + margin,
            axisLabel: { showMinLabel: false, showMaxLabel: false, formatter: (x) => short_number(x, 6) },
          },
          y: { name: "Island", inverse: true, min: rows[0], max: rows[1], minInterval: 1, axisLabel: { showMinLabel: false, showMaxLabel: false } },
        },
      ],
      cells,
    ),
    ...zooming(1),
    series,
    legend: legend(series, shown),
    tooltip: { trigger: "item", formatter: ({ value: point }) => tooltip_box(`Island ${point[1]}`, [`ln evidence ${number_text(point[0], 6)}`]) },
  };
  return { option, height };
}
