#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "api/handle.h"
#include "base/hash.h"
#include "base/linalg.h"
#include "base/pack.h"
#include "base/whole_file.h"

/* A file: the mark, everything of walk, and the hash of what stands before it. */
enum { SAVED_VERSION = 3 };
static const char MARK[8] = "imtetask";
enum { TEXT_MAX = 1 << 20, COUNT_MAX = 1 << 30, KERNELS_MAX = 64 };

/* -- the walk over what is saved (base/pack.h) --------------------------------------------------------------------- */

static void walk_text(Pack *p, char *text, size_t size)
{
    size_t n = p->reading ? 0 : strlen(text);
    pack_size(p, &n, size - 1);
    pack(p, text, n);
    if (p->reading)
        text[p->faulty ? 0 : n] = 0;
}

/* One told design, or one that is only asked for. */
static void walk_row(Pack *p, imtet_search *s, size_t i, Err *err)
{
    Evaluation *e = &s->table.row[i];
    size_t told = s->design[i].place == DESIGN_TOLD, outcome = e->outcome, kind = e->kind, generation = e->generation;
    char reason[REASON_MAX];
    text_copy(reason, e->reason ? e->reason : "");
    pack_numbers(p, e->x, s->table.n_var, -INFINITY, INFINITY);
    pack(p, e->f, s->table.n_obj * sizeof *e->f); /* not numbers where it failed */
    pack(p, e->extra, s->table.n_extra * sizeof *e->extra);
    pack_size(p, &told, 1);
    pack_size(p, &outcome, OUTCOME_COUNT - 1);
    pack_size(p, &kind, KIND_COUNT - 1);
    pack_size(p, &generation, COUNT_MAX);
    walk_text(p, reason, sizeof reason);
    if (!p->reading || p->faulty)
        return;
    p->faulty = reason[0] && evaluation_table_give_room(e, err) != STATUS_OK;
    if (!p->faulty)
        evaluation_set_outcome(e, (Outcome)outcome, reason);
    e->kind = (EvaluationKind)kind;
    e->generation = generation;
    s->design[i].place = told ? DESIGN_TOLD : DESIGN_FREE;
    s->n_told += told;
}

/* Everything behind the settings and counts of a search. */
static void walk(Pack *p, imtet_search *s, Err *err)
{
    const size_t n_var = s->schema.n_var;
    size_t n = s->table.n;

    /* 1. Bounds, designs to begin with, and every row. A damaged count of rows is found before room is made for
     * them. */
    pack(p, s->lower, (2 + s->n_given) * n_var * sizeof *s->lower);
    pack_size(p, &n, COUNT_MAX);
    for (size_t i = 0; i < n && !p->faulty; i++) {
        p->faulty =
            p->reading && (p->n - p->at < n_var * sizeof *s->lower || handle_add(s, s->lower, err) != STATUS_OK);
        if (!p->faulty)
            walk_row(p, s, i, err);
    }

    /* 2. The state of the search: what has entered it is told, and one that has asked for anything has a state. */
    pack_size(p, &s->n_entered, s->table.n);
    pack_size(p, &s->n_state, p->reading ? p->n - p->at : SIZE_MAX);
    if (p->reading && !p->faulty && s->n_state > 0) {
        s->state = malloc(s->n_state);
        p->faulty = !s->state;
    }
    pack(p, s->state, s->n_state);
    for (size_t i = 0; i < s->n_entered && !p->faulty; i++)
        p->faulty = s->design[i].place != DESIGN_TOLD;
    p->faulty |= s->n_state == 0;
    pack_size(p, &s->failing, COUNT_MAX);
}

/* -- writing ------------------------------------------------------------------------------------------------------- */

/* The file that there is becomes PATH.prev, and the new one takes its place when it is whole on the disk: whenever the
 * program ends, PATH is one of the two, and what was PATH.prev is there until the other takes its place. The folder is
 * locked meanwhile, for other processes that save there; a file system without locks or links does without. */
static Status put_in_place(const Pack *p, const char *path, Err *err)
{
    char folder[PATH_MAX], before[PATH_MAX + 8], beside[PATH_MAX + 16];
    Output o;
    folder_of(path, folder);
    const int lock = open(folder, O_RDONLY | O_CLOEXEC);
    flock(lock, LOCK_EX);
    Status status = output_open_inside(&o, path, err);
    if (status == STATUS_OK) {
        fwrite(p->bytes, 1, p->n, o.stream);
        snprintf(before, sizeof before, "%s.prev", path);
        snprintf(beside, sizeof beside, "%s.tmp", before);
        unlink(beside); /* of a process that was killed here */
        if (link(path, beside) == 0) {
            (void)!rename(beside, before);
            unlink(beside); /* where it could not be renamed, or both were names of one file already */
        }
        status = output_close(&o, err);
    }
    close(lock);
    return status;
}

Status saved_write(imtet_search *s, const char *path, Err *err)
{
    Pack p = {0};
    const SearchView v = search_look(s->search);
    if (!v.state)
        return fail_memory(err, 1, "the state of the search");

    /* Pack the mark, the settings, kernels and counts, then the walk, then the hash of it all. */
    s->n_entered = v.all->n;
    s->n_state = v.n_state;
    s->state = (unsigned char *)(uintptr_t)v.state; /* the search's own */
    char *text = settings_text(&s->settings);
    pack(&p, (void *)(uintptr_t)MARK, sizeof MARK);
    pack_expect(&p, SAVED_VERSION);
    p.faulty |= !text;
    if (text)
        walk_text(&p, text, TEXT_MAX);
    walk_text(&p, (char *)(uintptr_t)linalg_kernel_name(), KERNELS_MAX);
    pack_size(&p, &s->schema.n_extra, CONSTRAINTS_MAX);
    pack_size(&p, &s->n_given, COUNT_MAX);
    walk(&p, s, err);
    s->state = NULL;
    uint64_t hash = hash_fnv1a(p.bytes, p.n, HASH_SEED);
    pack(&p, &hash, sizeof hash);
    const Status status = pack_finished(&p) ? put_in_place(&p, path, err) : fail_memory(err, 1, "the search as bytes");
    free(p.bytes);
    free(text);
    return status;
}

/* -- reading ------------------------------------------------------------------------------------------------------- */

/* Settings and counts, of these an empty search, then what it knew. */
static Status read_search(Pack *p, const char *path, imtet_search **out, Err *err)
{
    Settings settings;
    size_t n_con = 0, n_given = 0;
    char *text, kernels[KERNELS_MAX];
    TRY_ROOM(text, TEXT_MAX, "a search", err);
    walk_text(p, text, TEXT_MAX);
    walk_text(p, kernels, sizeof kernels);
    pack_size(p, &n_con, CONSTRAINTS_MAX);
    pack_size(p, &n_given, p->n);
    settings_defaults(&settings);
    const Status status =
        p->faulty ? bad_data(err, "%s: is damaged", path) : settings_parse(&settings, path, text, err);
    free(text);
    TRY(status);
    settings.problem.constraints = n_con;
    TRY(handle_create(out, &settings, n_given, err));
    walk(p, *out, err);
    if (!pack_finished(p))
        return bad_data(err, "%s: is damaged", path);
    (*out)->known = (*out)->table.n;
    TRY(handle_open(*out, err));
    if (strcmp(kernels, linalg_kernel_name()) != 0)
        snprintf(err->text, sizeof err->text,
                 "%.200s: was saved with BLAS kernels for %.40s; on those for %.40s the search goes on with other "
                 "designs (OPENBLAS_CORETYPE chooses kernels)",
                 path, kernels, linalg_kernel_name());
    return STATUS_OK;
}

/* Read the file whole; only one whose mark, hash and version are right is unpacked. */
Status saved_read(imtet_search **out, const char *path, Err *err)
{
    char *bytes;
    size_t n;
    uint64_t version, hash;
    Status status;
    TRY(file_read(path, FILE_LARGEST, &bytes, &n, err));
    if (n < sizeof MARK + sizeof version + sizeof hash || memcmp(bytes, MARK, sizeof MARK) != 0) {
        status = bad_data(err, "%s: is no saved search", path);
    } else {
        Pack p = {
            .bytes = (unsigned char *)bytes, .n = n - sizeof hash, .at = sizeof MARK + sizeof version, .reading = 1};
        memcpy(&version, bytes + sizeof MARK, sizeof version);
        memcpy(&hash, bytes + p.n, sizeof hash);
        if (hash != hash_fnv1a(bytes, p.n, HASH_SEED))
            status = bad_data(
                err,
                "%s: is damaged: its bytes are not those that were written; the save before has .prev behind the name",
                path);
        else if (version != SAVED_VERSION)
            status = bad_data(err, "%s: was saved by another version of imtet, which can go on with it", path);
        else
            status = read_search(&p, path, out, err);
    }
    free(bytes);
    return status;
}
