#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "cmd/commands.h"
#include "cmd/show.h"
#include "store/run_read.h"
#include "study/progress.h"

/* One line or one object; a run that cannot be read says why and the others follow. */
static void list_run(const char *name, const char *folder, json_t *list)
{
    Run run;
    Standing s;
    Err err = {0};
    if (run_read(&run, folder, &err) != STATUS_OK) {
        if (list)
            json_array_append_new(list, json_pack("{s:o, s:s, s:o}", "run", json_words(folder), "state", "unreadable",
                                                  "reason", json_words(err.text)));
        else
            printf("%-24s unreadable: %s\n", name, err.text);
        return;
    }
    standing_of(&s, folder, &run);
    const RunSession *last = run.n_sessions > 0 ? &run.session[run.n_sessions - 1] : NULL;
    const char *started = last ? last->started : "-";
    char hypervolume[32];
    number_words(s.hypervolume, 4, hypervolume);
    if (list)
        json_array_append_new(list, json_pack("{s:o, s:s, s:I, s:I, s:I, s:I, s:o, s:s}", "run", json_words(folder),
                                              "state", state_words(s.state), "simulated",
                                              (json_int_t)s.progress.simulated, "max_evals", (json_int_t)s.max_evals,
                                              "failed", (json_int_t)s.n_failed, "front", (json_int_t)run.n_front,
                                              "hypervolume", json_number(s.hypervolume), "started", started));
    else
        printf("%-24s %-10s %8zu of %-8ld %7zu %7zu %12s  %s\n", name, state_words(s.state), s.progress.simulated,
               s.max_evals, s.n_failed, run.n_front, hypervolume, started);
    run_free(&run);
}

static size_t list_folder(const char *folder, int n, struct dirent *const entries[], json_t *list)
{
    char path[PATH_MAX + 288], database[PATH_MAX + 320];
    size_t found = 0;
    for (int i = 0; i < n; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
        if (entries[i]->d_name[0] == '.' || !run_path(path, database, sizeof database))
            continue;
        if (found++ == 0 && !list)
            printf("%-24s %-10s %20s %7s %7s %12s  %s\n", "run", "state", "simulated", "failed", "front", "hypervolume",
                   "last start");
        list_run(entries[i]->d_name, path, list);
    }
    return found;
}

static Status run(const Args *args, Err *err)
{
    const char *folder = args->operand ? args->operand : "results";
    struct dirent **entries;
    const int n = scandir(folder, &entries, NULL, versionsort);
    if (n < 0)
        return fail(err, status_of_errno(errno, STATUS_MISSING), "%s: %s", folder, strerror(errno));
    json_t *list = args_has(args, "--json") ? json_array() : NULL;
    const size_t found = list_folder(folder, n, entries, list);
    for (int i = 0; i < n; i++)
        free(entries[i]);
    free(entries);
    if (list)
        return show_json(list, err);
    char path[PATH_MAX];
    if (found == 0 && run_path(folder, path, sizeof path))
        printf("%s: is a run itself; `imtet status` shows its progress\n", folder);
    else if (found == 0)
        printf("%s: no runs\n", folder);
    return STATUS_OK;
}

static const ArgOption OPTIONS[] = {OPTION_JSON, OPTION_END};

const Command CMD_LIST = {
    .name = "list",
    .operand = "[FOLDER]",
    .summary = "the runs of a folder and how far each is",
    .example = "imtet list results",
    .details = "One line for every run in FOLDER, `results` if none is given: running, finished, stopped (it can be "
               "resumed) or\n"
               "interrupted (it was killed, and can be resumed too).",
    .options = OPTIONS,
    .run = run,
    .only_reads = 1,
};
