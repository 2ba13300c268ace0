// What the report takes from Observable Plot and d3; the bundler leaves the rest out.
export { areaY, barX, cell, dot, legend, line, lineY, plot, raster, rectX, ruleX, ruleY, text } from "@observablehq/plot";
export {
  axisLeft, brush, brushY, deviation, drag, extent, greatest, group, interpolateViridis, least, max, mean, minIndex, range,
  rank, scaleLinear, scaleLog, select, sum, symbol, symbolCircle, symbolDiamond2, symbolSquare, symbolStar, symbolTriangle,
} from "d3";
