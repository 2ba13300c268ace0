#include "cmd/improve.h"

#include "cmd/designs.h"
#include "settings/options.h"
#include "store/run_read.h"
#include "study/named.h"

Status improve_run(const Args *args, Status (*work)(const Args *args, Improve *m, Err *err), Err *err)
{
    Improve m = {0};
    RecordPaths moved;
    const char *word = args_value(args, "--design");
    Status status = run_wanted(args->operand, err);
    THEN(status, store_open(&m.store, args->operand, 0, err));
    THEN(status, store_read(m.store, RUN_WHOLE, &m.run, err));
    THEN(status, design_of_run(&m.run, word ? word : "knee", &m.row, NULL, err));
    THEN(status, args_moved(args, &moved, err));
    THEN(status, record_paths_find(m.run.settings, m.run.provenance, &moved, err));
    THEN(status, work(args, &m, err));
    improved_free(&m.result);
    run_free(&m.run);
    store_free(m.store);
    return status;
}

Status improve_store(Improve *m, const Evaluation *design, Err *err)
{
    Run now;
    Adapter *a;
    const Run *run = &m->run;
    const Settings *s = run->settings;
    TRY(store_polished(m->store, design, run->tried_to_polish, run->polished_at, &m->id, err));
    const int is_over = run->n_sessions > 0 && run->session[run->n_sessions - 1].is_final; /* else its search goes on */
    if (is_over && named_are_known(s)) {
        TRY(adapter_open(&a, s, err));
        const Status status = named_simulate(m->store, s, adapter_problem(a), NULL, NULL, err);
        adapter_close(a);
        TRY(status);
    }
    TRY(store_write_front(m->store, &now, err));
    m->knee = now.n_front > 0 ? now.table.row[run_knee(&now)].id : -1;
    run_free(&now);
    return STATUS_OK;
}

void improve_row(const Improve *m, json_t *table, const char *label, size_t i, long id)
{
    const Evaluation *e = &m->result.designs.row[i];
    figures_design(table, label, id, &m->run.schema, e->f, m->result.error[i], e->sd, e->extra);
}

void improve_cost(Document *d, const char *before, const ImproveCost *c)
{
    document_say(d, "%s%zu designs tried in %zu simulations, %zu failed, %.1f s", before, c->n_evaluated,
                 c->n_simulated, c->n_failed, c->seconds);
}

void improve_say(Document *d, const Improve *m)
{
    const SimOptions *s = &m->run.settings->sim;
    const long before = m->run.n_front > 0 ? m->run.table.row[run_knee(&m->run)].id : 0;
    if (isfinite(m->result.designs.row[0].sd[0]))
        document_say(d, "sd: %s", spread_word(s->gap_tolerance_m, &s->uncertain));
    improve_cost(d, "", &m->result.cost);
    if (m->id)
        document_say(
            d, m->knee ? "stored in the run as design %ld." : "it is design %ld of the run: nothing new to store.",
            m->id);
    if (m->knee > 0 && m->knee != before)
        document_say(d, "%s:knee was design %ld and is now design %ld.", m->run.folder, before, m->knee);
}
