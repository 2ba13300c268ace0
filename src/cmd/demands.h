/* cmd/demands.h -- peaks of a design, a row per record, as FEMA P-58 tools read them.
 *
 * pelicun (NHERI SimCenter, 3.9), demand sample: first column without a name, then EVENT-TYPE-PLACE-DIRECTION,
 *   1-PFA-0-1 ... of the ground and every floor [g], 1-PID-1-1 ... of every storey, 1-RID-1-1 ... where storeys yield;
 *   a row of units, then the records, numbered from 0
 * EE-UQ, quoFEM, a file named response.csv: column id from 1, PFA [m/s2], PFD [m] and PID of the floors one after the
 *   other, 1-PRD-1-1 the peak of the roof over the height; no row of units */
#pragma once

#include "analysis/evaluations.h"

/* At one intensity. A simulation that failed has no row, which is said on standard error. */
Status demands_write(const Evaluations *e, const char *path, Err *err);
