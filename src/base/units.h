/* base/units.h -- the one constant that turns g into SI. */
#pragma once

static const double GRAVITY = 9.81; /* [m/s2] per g, throughout */
