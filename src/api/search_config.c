#include "api/search_config.h"

#include "settings/settings.h"

SearchConfig search_config_of(const Settings *s)
{
    return (SearchConfig){
        .seed = (uint32_t)s->search.seed,
        .population = s->search.population,
        .initial = MIN_OF(s->search.initial, s->search.max_evals),
        .max_evals = s->search.max_evals,
        .surrogate_max = SEARCH_CENTRES,
        .surrogate = s->search.surrogate,
        .fidelity = settings_screens(s) ? s->search.fidelity : FIDELITY_OFF,
        .ahead = s->search.ahead,
        .max_seconds = 3600 * fmax(s->search.max_hours, 0.0),
        .stop_after = s->search.stop_after,
        .replicate_share = s->search.replicate_share,
        .replicates_max = s->search.replicates_max,
    };
}
