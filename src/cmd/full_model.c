#include "cmd/full_model.h"

#include <limits.h>
#include <sys/stat.h>

#include "analysis/full_model.h"
#include "base/units.h"
#include "cmd/designs.h"
#include "cmd/show.h"
#include "scene/frame.h"
#include "settings/settings.h"

static const char *const WORDS[MODELS] = {"reduced", "full"};

typedef struct {
    SceneKind kind;
    Designs designs;
    size_t n;
    DesignSpace space;
    MeasureOrder order;
    int estimates;
    FullModel found; /* under the record at hand */
} Job;

/* ---- what is shown ----------------------------------------------------------------------------------------------- */

/* Both models of every design, and how far the reduced one is off. */
static Status verify_under(const Args *args, Job *job, const Settings *s, Document *d, Err *err)
{
    char label[DESIGN_LABEL_MAX + 32], name[DESIGN_LABEL_MAX], text[24];
    const FullModel *found = &job->found;
    const Motion *motion = &found->motion;
    TRY(full_model_find(s, job->kind, job->n, job->designs.x, job->estimates, &job->found, err));
    document_motion(d, motion, 0);
    document_say(d, "model (degrees of freedom)");
    json_t *table = document_table(d);
    for (size_t i = 0; i < job->n; i++) {
        const SimResult *reduced = &found->result[REDUCED][i], *full = &found->result[FULL][i];
        double error[N_MEASURES];
        json_t *o = json_object(), *of_reduced = json_object();
        for (int k = 0; k < N_MEASURES; k++) {
            const double is = measure_value(reduced, k), wanted = measure_value(full, k);
            error[k] = wanted == 0 && is == 0 ? 0 : is / wanted - 1;
        }
        put_measures(of_reduced, NULL, "", error, NULL, NULL);
        if (job->designs.x)
            json_put(o, "design=%ld", design_number(&job->designs, i));
        json_put(o, "record=%s pga_g=%g scale=%g stretch=%g degrees_of_freedom=%p reduced=%p full=%p error=%p",
                 motion->name, motion_peak(motion) / GRAVITY, motion->scale, motion->stretch,
                 json_of("reduced=%d full=%d", found->dofs[REDUCED], found->dofs[FULL]),
                 json_result(NULL, job->kind, reduced), json_result(NULL, job->kind, full), of_reduced);
        json_array_append_new(d->data, o);
        design_label(&job->designs, args_value(args, "--design"), i, name);
        for (int m = 0; m < MODELS; m++) {
            snprintf(label, sizeof label, "%s, %s (%d)", name, WORDS[m], found->dofs[m]);
            figures_result(table, label, &job->order, &found->result[m][i],
                           found->error ? found->error + i * N_MEASURES : NULL, NULL);
        }
        json_t *row = json_put(figures_row(table), "=%s", "  error of the reduced");
        for (int n = 0; n < job->order.n_obj; n++) {
            const int k = job->order.of[n];
            snprintf(text, sizeof text, "%.3f %%", 100 * error[k]);
            json_object_set_new(row, measures_name(&job->order, k), json_string(text));
        }
    }
    full_model_free(&job->found);
    return STATUS_OK;
}

/* --design; of a run also ID, knee, best_NAME alone. run NULL: there is none. */
Status show_full_model(const Args *args, Settings *s, const Run *run, Err *err)
{
    const int as_json = args_has(args, "--json");
    const char *pga = args_value(args, "--pga"), *word = args_value(args, "--design"), *path;
    char own[PATH_MAX + 64];
    struct stat there;
    Job job = {.n = 1, .estimates = s->sim.engine == ENGINE_FAST && !as_json};

    /* 1. What is asked for. */
    TRY(args_alone(args, "--full-model", "--csv --svg --replicates", err));
    if (!frame_is(s->building.model))
        return bad_data(
            err, "building.model: %s has no degrees of freedom besides its floors; a frame (nodes.csv) or guyan has",
            s->building.model);
    TRY(pga ? settings_put(s, "motion.pga_g", pga, err) : STATUS_OK);
    TRY(settings_check(s, err));
    TRY(!run || args_has(args, "--record") ? STATUS_OK : record_paths_check(s, run, err));
    s->sim.forces = as_json;
    TRY(tower_space(s, &job.space, err));
    TRY(measures_order(&job.order, s->search.objectives, s->search.limits, job.space.n_floors, err));

    /* --design; of a run also ID, knee, best_NAME alone. */
    if (word && strcmp(word, "none") == 0) {
        job.kind = SCENE_NO_CORE;
    } else {
        if (!word && !run)
            return misused(err, "--design is missing: " DESIGN_WORDS "; none: the building alone");
        if (run && (!word || (!strpbrk(word, "/:") && stat(word, &there) != 0))) {
            snprintf(own, sizeof own, "%s:%s", run->folder, word ? word : "knee");
            word = own;
        }
        TRY(designs_take(&job.designs, word, &job.space, s, !args_gives(args, "sim.accuracy"), NULL, err));
        job.n = job.designs.n;
    }

    /* 2. Under the settings' own record, or each that is named. */
    Document d = {.data = json_array()};
    Status status = args_has(args, "--record") ? STATUS_OK : verify_under(args, &job, s, &d, err);
    for (int i = 0; (path = args_next(args, "--record", &i));) {
        THEN(status, option_put_path(s->motion.record, path, err));
        THEN(status, verify_under(args, &job, s, &d, err));
    }
    d.data = json_only(d.data);
    THEN(status, document_give(&d, args, err));
    document_free(&d);
    design_free(&job.designs);
    return status;
}
