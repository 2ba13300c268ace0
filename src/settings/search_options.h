/* settings/search_options.h -- choices of the search (moga/search.h, moga/selection.h). */
#pragma once

#include "base/option.h"

/* On; off: variation alone. */
#define SURROGATE_USE_LIST(X) X(SURROGATE_ON, "on") X(SURROGATE_OFF, "off")
typedef enum { SURROGATE_USE_LIST(CHOICE_NAME) } SurrogateUse;

/* The part of most designs that is evaluated (moga/screening.c): the first replicate, or some of the records. */
#define FIDELITY_LIST(X) X(FIDELITY_OFF, "off") X(FIDELITY_REPLICATES, "replicates") X(FIDELITY_RECORDS, "records")
typedef enum { FIDELITY_LIST(CHOICE_NAME) } Fidelity;
