/* report/drawings.h -- drawings of a design as SVG, to stand in HTML: what is between tower and core, and curves over
 * the height and over time.
 *
 * Threads  no state */
#pragma once

#include "report/detail.h"

/* Section through tower and core, heights to scale, gaps in proportion to the largest finite one, walls to the largest
 * thickness; labels in mm. */
void draw_devices(FILE *out, const Detail *d, const Design *design);

enum { CURVES_SHOWN = 4 };

/* Curves over the floors beside each other, the same names for all panels. */
typedef struct {
    const char *title;
    double factor; /* to the unit of the title */
    int is_bars;
    const double *curve[CURVES_SHOWN]; /* (n floors); NULL: none, and values that are not finite are left out */
} Panel;
void draw_profiles(FILE *out, const Detail *d, const char *const names[CURVES_SHOWN], size_t n, const Panel panels[]);

/* Displacement of the detail's floor over time, with core and without. */
void draw_history(FILE *out, const Detail *d);
