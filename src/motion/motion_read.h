/* motion/motion_read.h -- files that hold a ground acceleration, in the forms that people have them.
 *
 *   at2      PEER                              cosmos   COSMOS 1.20 V1, V2
 *   csmip    CSMIP (CDMG, CGS), USGS V1, V2    smc      USGS SMC, volumes 1 and 2
 *   knet     K-NET, KiK-net                    esm      Engineering Strong Motion data base, ASCII
 *   geonet   GeoNet V1A, V2A                   jma      JMA, CSV
 *   cwb      CWB, CWA (Taiwan)                 afad     AFAD (Turkey)
 *   unam     UNAM (Mexico), ASA 2.0            bhrc     BHRC (Iran), volume 1
 *   usc      USC, volume 1                     isesd    ISESD and its CD-ROM, corrected
 *   slist    IRIS ASCII, and tspair            mseed    miniSEED 2
 *   sac      SAC, binary and alphanumeric      simcenter  SimCenter JSON
 *   csmnc    CSMNC (China)                     csn      CSN (Chile), text
 *   csv      plain text: one, two or many columns
 *
 * and archives of them (zip, tar, gzip, bzip2, xz).
 *
 * The kind of file is told by its content, not by its name. Lines end in LF or CRLF; bytes beyond ASCII are let pass in
 * words. docs/motions.md says what is read from each.
 *
 * Ownership  m->accel is allocated; motion_free releases it (after a failure there is nothing to free)
 * Threads    no state */
#pragma once

#include "motion/motion.h"
#include "motion/options.h"
#include "motion/text_form.h"

/* motion.unit: a word of MOTION_UNIT_LIST, counts with "=" and their number per m/s2. */
Status motion_unit_parse(const char *text, MotionUnit *unit, double *counts_per_m_s2, Err *err);

Status motion_read(Motion *m, const char *path, const MotionHow *how, Err *err);

/* The same from bytes in memory; `path` only names it in messages. */
Status motion_parse(Motion *m, const char *path, const char *text, size_t length, const MotionHow *how, Err *err);
