// The parts of ECharts that the page draws with; the bundle leaves out the others.
export { BarChart, CustomChart, HeatmapChart, LineChart, ScatterChart } from "echarts/charts";
export {
  DataZoomComponent,
  GridComponent,
  LegendComponent,
  TitleComponent,
  ToolboxComponent,
  TooltipComponent,
  VisualMapContinuousComponent,
} from "echarts/components";
export { CanvasRenderer, SVGRenderer } from "echarts/renderers";
