// What the report takes from Observable Plot and d3; the bundler leaves the rest out.
export {
  areaY, dot, line, lineY, plot, raster, rectX, rectY, ruleX, ruleY,
} from "@observablehq/plot";
export { axisLeft, brush, brushY, interpolateViridis, scaleLinear, scalePoint, select } from "d3";
