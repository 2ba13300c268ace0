/* The k-th call of one kind to the database, the files or the allocator fails: the run ends with a reason, and then
 * goes on to the same result. Where the store is driven alone, the first call of every stack of callers, as far as three of
 * ours, and every 64th of the others, or all with FAULTS in the environment (make faults); in a whole study a few of each
 * kind, or FAULTS=60 of them. The linker puts the functions below in the place of the real ones (Makefile). */
#include "runs.h"

#include <execinfo.h>
#include <sys/resource.h>

#include "base/hash.h"
#include "base/text.h"

enum { SOME = 3 };

typedef enum { STEP, EXEC, PREPARE, OPEN, CALLOC, MALLOC, REALLOC, COOKIE, FOPEN, FLUSH, RENAME, N_KINDS } Kind;
static const char *const KINDS[N_KINDS] = {"sqlite3_step",    "sqlite3_exec", "sqlite3_prepare_v2",
                                           "sqlite3_open_v2", "calloc",       "malloc",
                                           "realloc",         "fopencookie",  "fopen",
                                           "fflush",          "rename"};

typedef struct {
    int armed;
    Kind kind;
    long at, n[N_KINDS];
    int code;       /* what SQLite says of it */
    int rolls_back; /* as SQLite does by itself on a full disk or without memory */
    int struck;
} Fault;

static Fault fault;

/* Calls that were first of their kind with one stack of callers: what fails there differs; 1, 2, ... as `at`. */
enum { STACK = 5, SITES_MAX = 1024 };
static struct {
    size_t n;
    uint64_t stack[SITES_MAX];
    long first[SITES_MAX];
} sites[N_KINDS];

static void note_site(Kind kind, long at)
{
    void *callers[STACK];
    const int n = backtrace(callers, STACK);
    const uint64_t stack = hash_fnv1a(callers, (size_t)n * sizeof *callers, HASH_SEED);
    size_t i = 0;
    while (i < sites[kind].n && sites[kind].stack[i] != stack)
        i++;
    if (i < sites[kind].n || i == SITES_MAX)
        return;
    sites[kind].stack[i] = stack;
    sites[kind].first[i] = at;
    sites[kind].n++;
}

static int is_site(Kind kind, long at)
{
    size_t i = 0;
    while (i < sites[kind].n && sites[kind].first[i] != at)
        i++;
    return i < sites[kind].n;
}

static int fails(Kind kind)
{
    if (!fault.armed)
        return 0;
    fault.n[kind]++;
    if (fault.at == 0)
        note_site(kind, fault.n[kind]);
    const int now = kind == fault.kind && fault.n[kind] == fault.at;
    fault.struck = fault.struck || now;
    return now;
}

/* at = 0: calls are counted, none fails. */
static void arm(Kind kind, long at, int code)
{
    fault = (Fault){.kind = kind, .at = at, .code = code, .armed = 1};
}

#define WRAP(type, name, kind, failed, parameters, arguments)                                                          \
    type __real_##name parameters;                                                                                     \
    type __wrap_##name parameters;                                                                                     \
    type __wrap_##name parameters                                                                                      \
    {                                                                                                                  \
        return fails(kind) ? (failed) : __real_##name arguments;                                                       \
    }

#define EXEC_PARAMETERS                                                                                                \
    (sqlite3 * d, const char *sql, int (*f)(void *, int, char **, char **), void *user, char **message)
int __real_sqlite3_exec EXEC_PARAMETERS;
static int roll_back(sqlite3 *d, int code)
{
    if (fault.rolls_back && sqlite3_get_autocommit(d) == 0)
        __real_sqlite3_exec(d, "ROLLBACK", NULL, NULL, NULL);
    return code;
}

WRAP(int, sqlite3_step, STEP, roll_back(sqlite3_db_handle(s), SQLITE_IOERR), (sqlite3_stmt * s), (s))
WRAP(int, sqlite3_exec, EXEC, roll_back(d, SQLITE_FULL), EXEC_PARAMETERS, (d, sql, f, user, message))
WRAP(int, sqlite3_prepare_v2, PREPARE, SQLITE_NOMEM,
     (sqlite3 * d, const char *sql, int n, sqlite3_stmt **s, const char **tail), (d, sql, n, s, tail))
WRAP(int, sqlite3_open_v2, OPEN, SQLITE_CANTOPEN, (const char *path, sqlite3 **d, int flags, const char *vfs),
     (path, d, flags, vfs))
WRAP(void *, calloc, CALLOC, NULL, (size_t n, size_t size), (n, size))
WRAP(void *, malloc, MALLOC, NULL, (size_t size), (size))
WRAP(void *, realloc, REALLOC, NULL, (void *old, size_t size), (old, size))
WRAP(FILE *, fopencookie, COOKIE, NULL, (void *cookie, const char *mode, cookie_io_functions_t io), (cookie, mode, io))
WRAP(FILE *, fopen, FOPEN, NULL, (const char *path, const char *mode), (path, mode))
WRAP(int, fflush, FLUSH, EOF, (FILE * f), (f))
WRAP(int, rename, RENAME, -1, (const char *from, const char *to), (from, to))

#define WRAP_CODE(name)                                                                                                \
    int __real_##name(sqlite3 *d);                                                                                     \
    int __wrap_##name(sqlite3 *d);                                                                                     \
    int __wrap_##name(sqlite3 *d)                                                                                      \
    {                                                                                                                  \
        return fault.armed && fault.struck ? fault.code : __real_##name(d);                                            \
    }

WRAP_CODE(sqlite3_errcode)
WRAP_CODE(sqlite3_extended_errcode)

static void remove_in_place(const char *name)
{
    expect_shell("rm -rf '%s/%s'", place.folder, name);
}

/* -- a study ------------------------------------------------------------------------------------------------------- */

static Settings short_textbook(const char *out)
{
    Settings s = settings_of(TEXTBOOK, out);
    s.search.max_evals = 28;
    return s;
}

static Status study(const Settings *s, Err *why)
{
    StudySummary summary;
    return study_run(s, &(StudyOptions){0}, &summary, NULL, why);
}

static void fail_once(Kind kind, long at, const char *front)
{
    err = (Err){0};
    remove_in_place("faulty");
    const Settings s = short_textbook("faulty");
    if (at % 2 == 0) /* a first half, from which it goes on */
        study_stopped_after(17, &s);
    arm(kind, at, SQLITE_IOERR);
    const Status status = study(&s, &err);
    fault.armed = 0;
    if (status != STATUS_OK && !err.text[0])
        fail_msg("%s %ld: fails and says nothing", KINDS[kind], at);
    Err again = {0};
    if (status != STATUS_OK && study(&s, &again) != STATUS_OK)
        fail_msg("%s %ld: '%s', and then '%s'", KINDS[kind], at, err.text, again.text);
    FREED char *now = read_in_place("faulty/front.csv");
    if (strcmp(now, front) != 0)
        fail_msg("%s %ld: another front", KINDS[kind], at);
}

TEST(a_study_whose_kth_call_fails_goes_on_to_the_same_front)
{
    const char *wanted = getenv("FAULTS");
    const long most = wanted ? strtol(wanted, NULL, 10) : SOME;
    const Settings s = short_textbook("whole");
    long n[N_KINDS];
    arm(0, 0, SQLITE_OK);
    CHECK_OK(study(&s, &err), &err);
    fault.armed = 0;
    memcpy(n, fault.n, sizeof n);
    FREED char *front = read_in_place("whole/front.csv");
    for (Kind kind = 0; kind < N_KINDS; kind++)
        for (long at = 1; at <= n[kind]; at += n[kind] <= most ? 1 : (n[kind] + most - 1) / most)
            fail_once(kind, at, front);
}

/* -- the store alone ----------------------------------------------------------------------------------------------- */

static const char PLAIN[] = DTLZ2_INI(3, 2) "[search]\nmax_evals = 8\n";

/* Six designs in three generations: all fail; 4 is the front, the first objective the same for all; 6 beats it. */
enum { N_GENERATIONS = 3, N_DESIGNS = 6, N_POLISHED = 3 };
static const size_t UNTIL[N_GENERATIONS] = {2, 5, 6}, GENERATION[N_DESIGNS] = {0, 0, 1, 1, 1, 2};
static const double X[N_DESIGNS][3] = {{0.1}, {0.2}, {0.3}, {0.4}, {0.5}, {0.6}};
static const double F[N_DESIGNS][2] = {{NAN, NAN}, {NAN, NAN}, {1, 2}, {1, 1}, {NAN, NAN}, {0.5, 0.5}};
static const unsigned char OK[N_DESIGNS] = {0, 0, 1, 1, 0, 1}, KIND[N_DESIGNS] = {0, 0, 1, 1, 2, 2};
static const size_t REPLICATES[N_DESIGNS] = {1, 1, 1, 1, 1, 1};
static const unsigned char FRONT[N_GENERATIONS][N_DESIGNS] = {{0}, {0, 0, 0, 1}, {0, 0, 0, 0, 0, 1}};

static Archive rows_of_view;
static SearchView view_of(size_t g)
{
    rows_of_view = (Archive){.n = UNTIL[g],
                             .n_var = 3,
                             .n_obj = 2,
                             .X = (double *)X[0],
                             .F = (double *)F[0],
                             .Y = (double *)F[0],
                             .ok = (unsigned char *)OK,
                             .kind = (unsigned char *)KIND,
                             .generation = (size_t *)GENERATION,
                             .replicates = (size_t *)REPLICATES,
                             .on_front = (unsigned char *)FRONT[g],
                             .n_front = g > 0,
                             .n_failed = g > 0 ? 3 : 2};
    return (SearchView){.all = &rows_of_view,
                        .generation = g,
                        .reason = g + 1 == N_GENERATIONS ? STOP_EVALUATIONS : STOP_NONE,
                        .surrogate_error = NAN,
                        .state = "state",
                        .n_state = 5};
}

/* The fourth takes long enough to be committed at once. */
static Status simulate(RunStore *store, size_t i, Err *why)
{
    Evaluation e = {.id = (long)i + 1,
                    .generation = (long)GENERATION[i],
                    .kind = KIND_UNFINISHED,
                    .seconds = i == 3 ? 1.0 : 0.001,
                    .x = (double *)X[i],
                    .f = (double *)F[i],
                    .room = (char[REASON_MAX]){0}};
    evaluation_set_outcome(&e, OK[i] ? OUTCOME_OK : OUTCOME_DEAD, OK[i] ? "" : "it died");
    return store_evaluation(store, &e, why);
}

static Status generation(RunStore *store, size_t g, Err *why)
{
    const SearchView v = view_of(g);
    for (size_t i = g > 0 ? UNTIL[g - 1] : 0; i < UNTIL[g]; i++)
        TRY(simulate(store, i, why));
    TRY(store_generation(store, &v, &(SessionTimes){.run = 1.0, .session = 1.0}, why));
    TRY(store_event(store, json_pack("{s:s, s:i}", "event", "generation", "number", (int)g), why));
    return store_event(store, json_pack("{s:I}", "generation", (json_int_t)g), why);
}

static const Evaluation POLISHED[N_POLISHED] = {{.x = (double *)X[0], .f = (double *)F[5], .outcome = OUTCOME_OK},
                                                {.x = (double *)X[1], .f = (double *)F[3], .outcome = OUTCOME_OK},
                                                {.x = (double *)X[2], .outcome = OUTCOME_DEAD}};

static Status work(RunStore *store, const Settings *s, const Schema *schema, size_t n_generations, Err *why)
{
    const Run *h = store_run(store);
    OWNED(run_free) Run now = {0};
    TRY(h ? store_resume(store, schema, s, 1, why) : store_begin(store, schema, s, "{}", why));
    TRY(store_session(store, "a test", 1, 0, why));
    for (size_t g = h ? h->n_generations : 0; g < n_generations; g++)
        TRY(generation(store, g, why));
    TRY(store_read(store, RUN_WHOLE, &now, why));
    const long tried = now.tried_to_polish;
    if (n_generations == N_GENERATIONS && tried < 1)
        TRY(store_polished(store, &POLISHED[0], 1, N_DESIGNS, &(long){0}, why));
    return n_generations == N_GENERATIONS ? store_polished(store, NULL, 2, N_DESIGNS, NULL, why) : STATUS_OK;
}

static Status session(const char *folder, const Schema *schema, size_t n_generations, Err *why)
{
    RunStore *store;
    const Settings s = settings_of(PLAIN, "life");
    TRY(store_open(&store, folder, 0, why));
    const Status status = work(store, &s, schema, n_generations, why);
    if (status == STATUS_OK)
        return store_close(store, "the end", n_generations == N_GENERATIONS, 1.0, NULL, why);
    store_flush(store, &(Err){0}); /* as a study does */
    store_free(store);
    return status;
}

/* From wherever the run stands to its end, designs from outside included. */
static Status life(const char *folder, const Schema *schema, Err *why)
{
    OWNED(run_free) Run h = {0};
    TRY(session(folder, schema, N_GENERATIONS - 1, why));
    TRY(session(folder, schema, N_GENERATIONS, why));
    TRY(run_read(&h, folder, why));
    const size_t n = h.table.n;
    for (size_t k = n - N_DESIGNS; k < N_POLISHED; k++)
        TRY(add_to_run(folder, 1, POLISHED + k, NULL, why));
    return session(folder, schema, N_GENERATIONS, why);
}

/* The tables of a life, one behind the other. */
static char *tables(void)
{
    FREED char *front = read_in_place("life/front.csv"), *all = json_export(there("life"));
    return formatted("%s\n%s", front, all);
}

static void check_life(Kind kind, long at, int rolls_back, const char *folder, const Schema *schema, const char *wanted)
{
    Err again = {0};
    err = (Err){0};
    remove_in_place("life");
    arm(kind, at, SQLITE_IOERR);
    fault.rolls_back = rolls_back;
    const Status status = life(folder, schema, &err);
    fault.armed = 0;
    if (status != STATUS_OK && !err.text[0])
        fail_msg("%s %ld: fails and says nothing", KINDS[kind], at);
    if (life(folder, schema, &again) != STATUS_OK)
        fail_msg("%s %ld: '%s', and then '%s'", KINDS[kind], at, err.text, again.text);
    FREED char *now = tables();
    if (strcmp(now, wanted) != 0)
        fail_msg("%s %ld: '%s', and then other tables:\n%s\nwanted\n%s", KINDS[kind], at, err.text, now, wanted);
}

TEST(whichever_call_of_a_run_fails_it_goes_on_to_the_same_tables)
{
    char folder[PATH_MAX];
    long n[N_KINDS];
    OWNED(schema_free) Schema schema;
    const Settings s = settings_of(PLAIN, "life");
    CHECK_OK(schema_of(&schema, &s, 0, &err), &err);
    path_of("life", folder);
    arm(0, 0, SQLITE_OK);
    CHECK_OK(life(folder, &schema, &err), &err);
    fault.armed = 0;
    memcpy(n, fault.n, sizeof n);
    FREED char *wanted = tables();
    assert_non_null(strstr(wanted, "\n6,"));
    const long every = getenv("FAULTS") ? 1 : 64;
    long n_struck = 0;
    for (Kind kind = 0; kind < N_KINDS; kind++)
        for (long at = 1; at <= n[kind]; at++) {
            if (!is_site(kind, at) && at % every != 0)
                continue;
            n_struck++;
            check_life(kind, at, 0, folder, &schema, wanted);
            if (kind == STEP || kind == EXEC)
                check_life(kind, at, 1, folder, &schema, wanted);
        }
    print_message("%ld calls refused, of %ld, %ld, %ld, ...\n", n_struck, n[STEP], n[EXEC], n[PREPARE]);
}

/* What SQLite says becomes a status and words; who may not share the journal reads it without locks. */
TEST(every_fault_of_the_database_is_said_in_our_words)
{
    static const struct {
        int code;
        Status status;
        const char *words;
    } SAID[] = {{SQLITE_NOMEM, STATUS_NO_MEMORY, "out of memory"},
                {SQLITE_FULL, STATUS_IO, "the disk is full"},
                {SQLITE_PERM, STATUS_IO, "read-only"},
                {SQLITE_BUSY, STATUS_IO, "is busy"},
                {SQLITE_LOCKED, STATUS_IO, "is busy"},
                {SQLITE_CORRUPT, STATUS_IO, "is damaged"},
                {SQLITE_NOTADB, STATUS_IO, "is no database"},
                {SQLITE_IOERR, STATUS_IO, "read or written"},
                {SQLITE_READONLY, STATUS_OK, ""},
                {SQLITE_CANTOPEN, STATUS_OK, ""}};
    char folder[PATH_MAX], inside[PATH_MAX];
    RunStore *store;
    OWNED(schema_free) Schema schema;
    const Settings s = settings_of(PLAIN, "50% ?#");
    CHECK_OK(schema_of(&schema, &s, 0, &err), &err);
    CHECK_OK(session(path_of("50% ?#", folder), &schema, 1, &err), &err);
    for (size_t i = 0; i < sizeof SAID / sizeof SAID[0]; i++) {
        OWNED(run_free) Run h = {0};
        arm(PREPARE, 1, SAID[i].code);
        const Status status = run_read(&h, folder, &err);
        fault.armed = 0;
        if (status != SAID[i].status || (status != STATUS_OK && !strstr(err.text, SAID[i].words)))
            fail_msg("%d: %d, %s", SAID[i].code, status, err.text);
        if (status == STATUS_OK)
            assert_int_equal(h.table.n, UNTIL[0]);
    }
    CHECK_OK(store_open(&store, folder, 0, &err), &err);
    CHECK_OK(work(store, &s, &schema, 2, &err), &err);
    arm(PREPARE, 1, SQLITE_CANTOPEN); /* the journal is in use: the file alone would be an old run */
    OWNED(run_free) Run h = {0};
    CHECK_OK(run_read(&h, folder, &err), &err);
    fault.armed = 0;
    assert_int_equal(h.table.n, UNTIL[1]);
    store_free(store);
    Database *d;
    assert_refused(database_create(&d, path_of("nowhere/run.sqlite", inside), &err), STATUS_IO, "cannot be opened");
    assert_int_equal(database_open(&d, inside, DATABASE_READ, &err), STATUS_MISSING);
}

/* It is whole, or it is said. */
TEST(a_text_for_which_there_is_no_room_is_not_taken_for_whole)
{
    enum { LINES = 20000 };
    char *text;
    size_t length;
    int n_failed = 0, failed = 1;
    for (long at = 1; failed; at++) {
        arm(REALLOC, at, 0);
        FILE *f = text_open(&text, &length);
        assert_non_null(f);
        for (int i = 0; i < LINES; i++)
            fprintf(f, "%06d\n", i);
        failed = text_close(f);
        fault.armed = 0;
        assert_int_equal(failed != 0, fault.struck);
        assert_int_equal(failed ? 0 : 7 * LINES, failed ? 0 : strlen(text));
        n_failed += failed;
        free(text);
    }
    assert_less(3, n_failed);
}

/* place/././.../name, n characters. */
static const char *long_path(char path[], size_t n, const char *name)
{
    size_t i = (size_t)snprintf(path, n, "%s", place.folder);
    while (i + 2 + strlen(name) < n)
        i += (size_t)sprintf(path + i, "/.");
    snprintf(path + i, n + 1 - i, "/%s", name);
    return path;
}

static void refused_by_store(const char *folder, int fresh, const char *words)
{
    RunStore *store;
    assert_refused(store_open(&store, folder, fresh, &err), STATUS_IO, words);
    assert_null(store);
}

TEST(a_folder_that_cannot_hold_the_run_is_named_and_a_fresh_run_takes_the_next)
{
    char path[2 * PATH_MAX], other[PATH_MAX], old[PATH_MAX];
    RunStore *first, *second;
    Database *d;
    CHECK_OK(store_open(&first, path_of("old", old), 0, &err), &err);
    store_free(first);
    assert_int_equal(access(old, F_OK), -1); /* no run came of it */
    assert_int_equal(mkdir(old, 0777), 0);
    assert_int_equal(add_to_run(old, 1, POLISHED, NULL, &err), STATUS_MISSING);
    write_in_place("old/front.csv", "id\n");
    write_in_place("old/run.sqlite", "a run");
    refused_by_store(path_of("old/front.csv/run", other), 0, "cannot be made a folder");
    refused_by_store(long_path(path, PATH_MAX, "old"), 0, "the path is too long");
    refused_by_store(long_path(path, PATH_MAX - 65, "old"), 1, "the path is too long");
    assert_refused(database_create(&d, long_path(path, PATH_MAX + 8, "old"), &err), STATUS_IO, "path too long");

    CHECK_OK(store_open(&first, old, 1, &err), &err); /* what is there stays */
    assert_string_equal(store_folder(first), path_of("old-2", other));
    CHECK_OK(store_open(&second, old, 1, &err), &err); /* the first is at work */
    assert_string_equal(store_folder(second), path_of("old-3", other));
    store_free(second);
    store_free(first);
}

TEST(a_database_that_is_removed_behind_the_search_is_put_back)
{
    RunStore *store;
    OWNED(schema_free) Schema schema;
    const Settings s = settings_of(PLAIN, "behind");
    CHECK_OK(schema_of(&schema, &s, 0, &err), &err);
    CHECK_OK(store_open(&store, there("behind"), 0, &err), &err);
    CHECK_OK(work(store, &s, &schema, N_GENERATIONS - 1, &err), &err);
    expect_shell("rm '%s'", there("behind/run.sqlite"));
    assert_refused(store_close(store, "the end", 0, 1.0, NULL, &err), STATUS_IO, "what it held was put back");
    CHECK_OK(session(there("behind"), &schema, N_GENERATIONS, &err), &err);
}

/* Designs for a run that has none yet; and generations that the store cannot keep. */
TEST(a_generation_that_was_not_simulated_is_refused)
{
    char folder[PATH_MAX];
    RunStore *store;
    OWNED(schema_free) Schema schema;
    long first;
    const Settings s = settings_of(PLAIN, "early");
    CHECK_OK(schema_of(&schema, &s, 0, &err), &err);
    CHECK_OK(session(path_of("early", folder), &schema, 0, &err), &err);
    CHECK_OK(add_to_run(folder, 1, POLISHED, &first, &err), &err);
    assert_int_equal(first, 1);
    remove_in_place("early");
    CHECK_OK(session(folder, &schema, 0, &err), &err);
    CHECK_OK(store_open(&store, folder, 0, &err), &err);
    CHECK_OK(store_resume(store, &schema, &s, 0, &err), &err);
    SearchView v = view_of(0);
    assert_refused(store_generation(store, &v, &(SessionTimes){0}, &err), STATUS_INTERNAL,
                   "the search knows of evaluation 1, which is not stored");
    v.state = NULL;
    assert_int_equal(store_generation(store, &v, &(SessionTimes){0}, &err), STATUS_NO_MEMORY);
    store_free(store);
}

/* Where there is a disk of memory: thousands of commits. */
static int make_quick_place(void **state)
{
    json_set_alloc_funcs(__wrap_malloc, free);
    if (make_place(state) != 0)
        return -1;
    if (access("/dev/shm", W_OK) != 0)
        return 0;
    rmdir(place.folder);
    snprintf(place.folder, sizeof place.folder, "/dev/shm/imtet-XXXXXX");
    return mkdtemp(place.folder) ? 0 : -1;
}

SUITE(make_quick_place, clear_place)
