/* cmd/dossier.h -- the one document about a design for who has to check it: HTML that prints on some ten pages of
 * A4, or a PDF of it by Chromium. Its charts are drawn by the scripts of the report, under the same policy.
 *
 *   what is there from the report   the design beside its baselines, its ladder, other earthquakes (report/detail.h)
 *   what is simulated for it        at accuracy fine, by CVODE, on the full model; sensitivities; replicates as
 *                                   built; all records at six intensities
 *
 * A part that cannot be had (a building without a full model, a simulation that failed) says why in its place.
 *
 * Errors  those of the file; no Chromium for a PDF: STATUS_MISSING, before anything is simulated */
#pragma once

#include "report/report.h"

/* Whether the file can be made: "-" is standard output, a name that ends in .pdf needs a program. */
Status dossier_check(const char *path, Err *err);

/* s: settings of the run, its records where they are now; records (n): those of the study first. */
Status dossier_write(const Report *r, const Settings *s, size_t n, const char *const records[], const char *path,
                     Err *err);
