/* base/units.h -- the one constant that turns g into SI. */
#ifndef IMTET_BASE_UNITS_H
#define IMTET_BASE_UNITS_H

static const double GRAVITY = 9.81; /* [m/s2] per g, throughout */

#endif
