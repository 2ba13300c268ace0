#include <unistd.h>

#include "cmd/commands.h"
#include "cmd/show.h"
#include "run/front.h"
#include "run/place.h"
#include "run/study.h"

enum { QUIET_GENERATIONS = 10 };

typedef struct {
    int terminal;
    size_t max_evals;
} Telling;

static void tell(const SearchView *view, void *user)
{
    const Telling *t = user;
    if (!t->terminal && view->generation_now % QUIET_GENERATIONS != 0)
        return;
    fprintf(stderr, "%sgeneration %zu: %zu of %zu simulated, %zu failed, %zu on the front, %.0f s%s",
            t->terminal ? "\r" : "", view->generation_now, view->n, t->max_evals, view->n_failed, view->n_front,
            view->seconds, t->terminal ? "  " : "\n");
}

static void print_front(const Front *front, const StudySummary *summary)
{
    char label[TABLE_NAME_MAX + 8];
    show_objective_names(&front->schema);
    for (size_t k = 0; k < front->n_obj; k++) {
        const size_t i = front_best(front, k);
        snprintf(label, sizeof label, "best %s", schema_objective(&front->schema, k)->name);
        show_objectives(label, front_id(front, i), front->n_obj, front_f(front, i));
    }
    const size_t knee = front_knee(front);
    show_objectives("knee", front_id(front, knee), front->n_obj, front_f(front, knee));
    if (summary->has_no_core) {
        double alone[N_OBJECTIVES];
        for (int k = 0; k < N_OBJECTIVES; k++)
            alone[k] = measure_value(&summary->no_core, k);
        show_objectives("no core", 0, N_OBJECTIVES, alone);
        printf("\nj1 displacement, j2 interstorey drift, j3 acceleration, ed1 share of mode 1, mcore: less is better;\n"
               "ed5_10 share of modes 5 to 10, edcs share of the core: more is better.");
    }
    printf("\nknee: nearest to the ideal point when every objective is scaled to 0..1 over the front.\n");
}

static Status report(const StudySummary *summary, Err *err)
{
    Front front;
    if (summary->n_front == 0)
        return fail(err, STATUS_INTERNAL, "none of %zu simulations succeeded; %s/evaluations.csv says why",
                    summary->n_simulated, summary->folder);
    TRY(front_read(&front, summary->folder, err));
    printf("front: %s/front.csv\n%zu nondominated of %zu simulated designs, %zu simulations failed, %.1f s (%s)\n\n",
           summary->folder, summary->n_front, summary->n_simulated, summary->n_failed, summary->seconds,
           stop_reason_words(summary->stopped));
    print_front(&front, summary);
    front_free(&front);
    return STATUS_OK;
}

static Status run(const Args *args, Err *err)
{
    Settings s;
    StudySummary summary;
    TRY(args_settings(args, &s, NULL, NULL, err));
    if (!args_gives(args, "run.out"))
        TRY(place_check(s.run.out, args->operand, err));
    Telling telling = {isatty(STDERR_FILENO), (size_t)s.search.max_evals};
    const Status status = study_run(&s, args_has(args, "--out"), tell, &telling, &summary, err);
    if (telling.terminal)
        fputc('\n', stderr);
    TRY(status);
    return report(&summary, err);
}

static const ArgOption OPTIONS[] = {
    OPTION_RECORD,
    OPTION_PGA,
    OPTION_STRETCH,
    OPTION_UNIT,
    {"--out", "DIR", "run.out", 0, "the run's folder; it must not hold a run yet"},
    {"--seed", "N", "search.seed", 0, "same seed, same settings: same front"},
    {"--threads", "N", "search.threads", 0, "0: one per processor"},
    {"--max-evals", "N", "search.max_evals", 0, "stop after so many simulations"},
    {"--max-hours", "H", "search.max_hours", 0, "stop after so long"},
    OPTION_SET,
    OPTION_END,
};

const Command CMD_OPTIMIZE = {
    .name = "optimize",
    .operand = "CONFIG",
    .summary = "search for the Pareto front of designs",
    .example = "imtet optimize configs/quick.ini",
    .details =
        "Searches gaps and wall thicknesses for the designs that no other one beats in all seven objectives, and\n"
        "writes them to DIR/front.csv generation by generation (results/README.md explains every file and\n"
        "column). Without --out the folder is run.out of CONFIG, with a number added where that holds a run.\n"
        "With problem.kind = external the simulator is a program of your own (docs/external.md).",
    .options = OPTIONS,
    .run = run,
};
