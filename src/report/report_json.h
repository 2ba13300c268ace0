/* report/report_json.h -- what the page draws, as JSON: the run, and one design in detail.
 *
 * The designs of the front are not in it: the page has them as rows of front.csv (report/page.c).
 *
 * Ownership  the caller's reference. Errors  no memory, or a name that is no UTF-8: NULL */
#pragma once

#include <jansson.h>

#include "report/report.h"

json_t *report_json(const Report *r);

/* Designs that were kept of what-if: [{"name", "id", "x", "raw": objectives, "ground": as a question of the page}]. */
json_t *kept_json(const Report *r);

/* Growth of the hypervolume: {"simulated": [], "volume": [], "error": []} of the generations that have one. */
json_t *growth_json(const Run *run);

/* One simulation: objectives, closings, every measure and part by its name; {"reason"} where it failed. */
json_t *result_json(SceneKind kind, const SimResult *r, const MeasureOrder *order);
json_t *put_parts(json_t *o, SceneKind kind, const SimResult *r); /* those parts; returns o */

/* explained, total, centres; null: too few designs succeeded. */
json_t *importance_json(const Importance *m, const Schema *schema);

/* Details of a tower: gaps, thickness, peaks and shares beside the baselines, histories, other earthquakes. */
json_t *detail_json(const Detail *d, const MeasureOrder *order);
