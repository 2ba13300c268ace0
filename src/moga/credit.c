#include "moga/credit.h"

#include "moga/constants.h"

int credit_prefers_first(const Credit *c)
{
    return c->gain / c->designs > (1.0 - c->gain) / (1.0 - c->designs);
}

/* Nothing is learnt where one criterion had no result, or there was no gain. */
void credit_learn(Credit *c, const CreditResults *r)
{
    double share = 0.0, measures = 0.0;
    for (int k = 0; k < INFILL_KINDS; k++) {
        const double all = r->gain[k][0] + r->gain[k][1];
        share += all > 0.0 ? r->gain[k][0] / all : 0.0;
        measures += all > 0.0;
    }
    if (measures == 0.0 || r->designs[0] == 0.0 || r->designs[1] == 0.0)
        return;
    c->gain += CREDIT_WEIGHT * (share / measures - c->gain);
    c->designs += CREDIT_WEIGHT * (r->designs[0] / (r->designs[0] + r->designs[1]) - c->designs);
}
