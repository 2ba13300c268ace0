/* moga/options.h -- choices of the search (moga/search.h, moga/selection.h). */
#ifndef IMTET_MOGA_OPTIONS_H
#define IMTET_MOGA_OPTIONS_H

#include "base/option.h"

/* On; off: variation alone; auto: on until its wall time per design exceeds that of COST_MAX simulations. Auto is
 * decided once, by the clock, and is part of the state: a resumed search keeps it, another one from the beginning may
 * decide otherwise where the costs are near the limit. */
#define SURROGATE_USE_LIST(X) X(SURROGATE_ON, "on") X(SURROGATE_OFF, "off") X(SURROGATE_AUTO, "auto")
typedef enum { SURROGATE_USE_LIST(CHOICE_NAME) } SurrogateUse;

/* What of most designs is evaluated alone (moga/fidelity.h): the first replicate of every record, or a cheap level. */
#define FIDELITY_LIST(X) X(FIDELITY_OFF, "off") X(FIDELITY_REPLICATES, "replicates") X(FIDELITY_LEVELS, "levels")
typedef enum { FIDELITY_LIST(CHOICE_NAME) } Fidelity;

#define SELECTION_KIND_LIST(X) X(SELECTION_NSGA3, "nsga3") X(SELECTION_RVEA, "rvea")
typedef enum { SELECTION_KIND_LIST(CHOICE_NAME) } SelectionKind;

#endif
