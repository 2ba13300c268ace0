/* cmd/selftest.h -- whether this build gives the answers that it should: linear structures, impacts before their
 * predictability horizon, a search on a textbook problem. */
#pragma once

#include "base/status.h"

/* STATUS_INTERNAL where an answer differs. */
Status selftest(int as_json, Err *err);
