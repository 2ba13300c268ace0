/* report/what_if.h -- what a page needs to simulate designs of a run itself (src/wasm/engine.c).
 *
 *   {"lower": [n_var], "upper", "values": of every variable the numbers that it takes, else null,
 *    "pga_g": [least, as in the run, most], "stretch", "restitution", "records": [names],
 *    "simulations": by which the run judges a design, "options": of `imtet simulate` that make it one simulation,
 *    "scene": the bytes of evaluate/portable.h, gzip, base64}
 *
 * The scene holds the records themselves: whoever gets the page gets them.
 *
 * Errors   no run of the tower: STATUS_MISSING; records that are gone: as study/record_paths.h. Threads  no state */
#pragma once

#include <jansson.h>

#include "study/record_paths.h"

/* n bytes as gzip, and two more of 0, to be freed; NULL: too many, or no memory. */
void *gzip_bytes(const void *bytes, size_t n, size_t *n_packed);

Status what_if_json(const Run *run, const RecordPaths *moved, json_t **out, Err *err);
