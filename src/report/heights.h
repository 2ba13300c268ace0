/* report/heights.h -- quantities over the height of a building: panels beside each other, drawn by gnuplot.
 *
 * Threads  no state */
#ifndef IMTET_REPORT_HEIGHTS_H
#define IMTET_REPORT_HEIGHTS_H

#include "base/status.h"

enum { HEIGHT_CURVES_MAX = 4 };

typedef struct {
    const char *title;                      /* also the unit */
    const double *curve[HEIGHT_CURVES_MAX]; /* (n) floor by floor; NULL: none */
    const char *name[HEIGHT_CURVES_MAX];    /* NULL: not in the key */
    int from_ground;                        /* the curve begins with 0 at the ground */
} HeightPanel;

typedef struct {
    const char *title;
    int n;           /* floors */
    const double *z; /* (n) [m] */
    int columns;     /* panels in a row */
    int n_panels;
    const HeightPanel *panel; /* (n_panels) */
} Heights;

/* SVG into path. */
Status heights_draw(const Heights *h, const char *path, Err *err);

#endif
