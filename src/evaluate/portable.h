/* evaluate/portable.h -- all that a simulation needs and files hold, as bytes: for a machine without those files,
 * such as the page of a report.
 *
 *   settings    text of settings_text, and the steps per contact that no setting says
 *   buildings   building.model, and core.model where a neighbour is given: matrices and heights as read
 *   records     every motion of the study as read, before it is scaled
 *
 * What is made of these (modes, P-delta, scaled motions, the scene) is made again by the same code.
 * Numbers are in the order of bytes of the machine, counts have 64 bits.
 *
 * Ownership  portable_make allocates, portable_free releases; after portable_read `bytes` must stay: buildings are read
 *            from them anew. Threads  no state */
#pragma once

#include "base/pack.h"
#include "motion/motion.h"
#include "scene/building_read.h"
#include "settings/settings.h"

enum { PORTABLE_RECORDS_MAX = 64 };

typedef struct {
    Settings settings;
    size_t n_records;
    Motion record[PORTABLE_RECORDS_MAX];                /* as motion_open reads them */
    char source[PORTABLE_RECORDS_MAX][OPTION_TEXT_MAX]; /* as motion.record names them */
    const unsigned char *buildings;                     /* of portable_read: where they begin in its bytes */
    size_t n_buildings_bytes;
} Portable;

/* The settings' buildings and records, read from their files, as bytes to be freed. */
Status portable_make(const Settings *s, unsigned char **bytes, size_t *n, Err *err);

Status portable_read(Portable *p, const unsigned char *bytes, size_t n, Err *err);

/* Gives what building_read would have read of this model. STATUS_MISSING: the bytes have no model of that name. */
Status portable_building(const Portable *p, const char *model, BuildingFiles *out, Err *err);
void portable_free(Portable *p);
