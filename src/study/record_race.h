/* study/record_race.h -- search.fidelity = records: by a sample of designs under all records of the study, which of
 * them every design of the search sees first (evaluate/race.h). The sample is simulated at the beginning of every
 * session, is no part of the run and costs PILOT evaluations. */
#pragma once

#include "evaluate/adapter.h"

enum { PILOT = 8 };

/* Nothing where designs are not screened by records. */
Status record_race(Adapter *a, const Settings *s, Err *err);
