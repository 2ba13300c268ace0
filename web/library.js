// What the report takes from Observable Plot and d3; the bundler leaves the rest out.
export {
  areaY, barX, cell, dot, legend, line, lineY, plot, raster, rectX, rectY, ruleX, ruleY, text,
} from "@observablehq/plot";
export {
  axisLeft, brush, brushY, drag, interpolateViridis, rank, scaleLinear, scaleLog, scalePoint, select, symbol,
  symbolCircle, symbolDiamond2, symbolSquare, symbolStar, symbolTriangle,
} from "d3";
