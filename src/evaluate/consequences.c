#include "evaluate/consequences.h"

#include "base/figure.h"
#include "base/text.h"

const struct DamagePart DAMAGE_PARTS[N_PARTS] = {
    {"structure", "steel frame", {0.006, 0.012, 0.03, 0.08}, 0.4, {0.004, 0.019, 0.096, 0.192}},
    {"drift_sensitive", "parts sensitive to drift", {0.004, 0.008, 0.025, 0.05}, 0.5, {0.007, 0.033, 0.164, 0.329}},
    {"acceleration_sensitive",
     "parts sensitive to acceleration",
     {0.3, 0.6, 1.2, 2.4},
     0.6,
     {0.009, 0.048, 0.144, 0.479}},
};

int damage_state(DamagedPart part, double demand)
{
    int state = 0;
    while (state < DAMAGE_STATES && demand >= DAMAGE_PARTS[part].median[state])
        state++;
    return state;
}

const char *damage_word(int state)
{
    static const char *const WORDS[] = {"none", "slight", "moderate", "extensive", "complete"};
    return WORDS[state];
}

double damage_cost(DamagedPart part, double demand)
{
    const struct DamagePart *d = &DAMAGE_PARTS[part];
    double cost = 0, before = 0;
    for (int s = 0; s < DAMAGE_STATES; s++) {
        cost += 0.5 * erfc(-log(demand / d->median[s]) / (d->beta * M_SQRT2)) * (d->cost[s] - before);
        before = d->cost[s];
    }
    return cost;
}

/* Of a building of n floors. */
static double loss_of(const RepairOptions *repair, int n, const double drift_ratio[], const double acceleration_g[])
{
    const double share[N_PARTS] = {repair->structure, repair->drift_sensitive, repair->acceleration_sensitive};
    double loss = 0;
    for (DamagedPart p = 0; p < N_PARTS; p++) {
        const double *demand = p == PART_ACCELERATION ? acceleration_g : drift_ratio;
        for (int j = 0; j < n; j++)
            loss += damage_cost(p, demand[j]) * (share[p] / DAMAGE_PARTS[p].cost[DAMAGE_STATES - 1]) / n;
    }
    return loss;
}

double damage_loss(const SimResult *r)
{
    return loss_of(&r->repair, r->n_floors, r->drift_ratio, r->peak_acceleration_g);
}

double damage_loss_of_neighbour(const SimResult *r)
{
    return loss_of(&r->repair, r->neighbour.n, r->neighbour.peak_drift_ratio, r->neighbour.acceleration_g);
}

const char *damage_words(const SimResult *r, char text[DAMAGE_WORDS_MAX])
{
    char figure[FIGURE_MAX];
    text[0] = 0;
    for (DamagedPart p = 0; p < N_PARTS && r->outcome == RUN_OK; p++) {
        const int is_drift = p != PART_ACCELERATION;
        const double worst = is_drift ? r->drift_ratio_max : r->j3_g;
        const int state = damage_state(p, worst);
        figure_text(is_drift ? 100 * worst : worst, NAN, NAN, "", figure);
        text_join(text, DAMAGE_WORDS_MAX, ", ", "%s%s: %s%s (%s%s)",
                  p ? "" : "damage by Hazus: ", DAMAGE_PARTS[p].words, state == DAMAGE_STATES ? "beyond " : "",
                  damage_word(state), figure, is_drift ? " %" : " g");
    }
    figure_text(100 * damage_loss(r), NAN, NAN, "", figure);
    if (r->outcome == RUN_OK)
        text_join(text, DAMAGE_WORDS_MAX, "; ", "repair some %s %% of replacement", figure);
    return text;
}
