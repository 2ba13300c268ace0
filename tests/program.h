/* tests/program.h -- runs $IMTET in the repository's root, as a person would, and reads what it says. The files of a
 * test program lie in a folder of its own, made by make_place and removed by clear_place. */
#pragma once

#include "check.h"

#include <jansson.h>
#include <sys/wait.h>

#include "base/csv.h"

/* A tower of six floors whose gaps close, in a few seconds of a record: what the program does with twenty floors, in a
 * tenth of the time. As options and as a settings file. */
#define SIX_FLOORS                                                                                                     \
    "--set building.model=configs/neighbours/tower --set core.width_m=5 --set design.gap_m=0.001,0.05 "                \
    "--set motion.stretch=1 "
#define SIX_FLOORS_INI                                                                                                 \
    "[building]\nmodel = /proc/self/cwd/configs/neighbours/tower\n[core]\nwidth_m = 5\n"                               \
    "[design]\ngap_m = 0.001, 0.05\n[motion]\npga_g = 0.3\n"

/* A worker that answers with DTLZ2 (bench/textbook.h). As options and as a settings file. */
#define DTLZ2(n_var, n_obj)                                                                                            \
    "--set problem.kind=external --set problem.variables=" #n_var " --set problem.objectives=" #n_obj                  \
    " --set 'problem.command=" TEXTBOOK_WORKER " dtlz2 " #n_var " " #n_obj "' "
#define DTLZ2_INI(n_var, n_obj)                                                                                        \
    "[problem]\nkind = external\ncommand = " TEXTBOOK_WORKER " dtlz2 " #n_var " " #n_obj "\nvariables = " #n_var       \
    "\nobjectives = " #n_obj "\n"

typedef struct {
    int code; /* exit status */
    char *out, *err;
} Said;

typedef struct {
    char folder[64]; /* of this test program's files */
    char under[256]; /* what the program is run under: a command, its arguments; empty: nothing */
} Place;

static Place place;

__attribute__((noinline)) static char *text_of(const char *path)
{
    char *text;
    size_t length;
    CHECK_OK(file_read(path, FILE_LARGEST, &text, &length, &err), &err);
    return text;
}

static inline char *in_place(const char *name)
{
    return formatted("%s/%s", place.folder, name);
}

/* The same, not to be freed (brief). */
#define there(name) brief("%s/%s", place.folder, name)

/* The words of the format in `to`; @ stands for the test's own folder. */
__attribute__((format(printf, 3, 0))) static inline void spread(char *to, size_t size, const char *format, va_list list)
{
    char words[2048];
    size_t n = 0;
    vsnprintf(words, sizeof words, format, list);
    to[0] = 0;
    for (const char *p = words; *p && n + sizeof place.folder < size; p++)
        n += (size_t)(*p == '@' ? sprintf(to + n, "%s", place.folder) : sprintf(to + n, "%c", *p));
}

/* Runs `imtet ARGUMENTS` through the shell; @ in the format stands for the test's own folder. */
__attribute__((format(printf, 2, 3))) static inline void run(Said *said, const char *format, ...)
{
    char arguments[4096];
    va_list list;
    va_start(list, format);
    spread(arguments, sizeof arguments, format, list);
    va_end(list);
    FREED char *command = formatted("exec >%s/out 2>%s/err; %s '%s' %s", place.folder, place.folder, place.under,
                                    getenv("IMTET"), arguments);
    const int status = system(command);
    said->code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    said->out = text_of(there("out"));
    said->err = text_of(there("err"));
}

static inline void forget(Said *said)
{
    free(said->out);
    free(said->err);
}

/* Runs, and expects that exit status and that text on standard error. */
static inline void expect(int code, const char *message, const char *arguments)
{
    OWNED(forget) Said s;
    run(&s, "%s", arguments);
    if (s.code != code || !strstr(s.err, message))
        fail_msg("imtet %s\n  exit %d (wanted %d), said: %s  wanted: %s", arguments, s.code, code, s.err, message);
}

/* What it prints, with status 0; to be freed. */
#define output_of(...) output_from(formatted(__VA_ARGS__))
static inline char *output_from(char *arguments)
{
    Said s;
    run(&s, "%s", arguments);
    if (s.code != 0)
        fail_msg("imtet %s\n  exit %d, said: %s", arguments, s.code, s.err);
    free(arguments);
    free(s.err);
    return s.out;
}

/* Runs, and expects the words on standard output. */
static inline void expect_output(const char *words, const char *arguments)
{
    FREED char *text = output_of("%s", arguments);
    if (!strstr(text, words))
        fail_msg("imtet %s\n  said: %s  wanted: %s", arguments, text, words);
}

static inline void assert_same_output(const char *arguments, const char *others)
{
    FREED char *a = output_of("%s", arguments), *b = output_of("%s", others);
    assert_string_equal(a, b);
}

/* Every evaluation of a run, as `imtet export --all` writes them; to be freed. */
static inline char *all_of(const char *run)
{
    return output_of("export @/%s --all --csv -", run);
}

/* Evaluations of its finished generations; 0: there is no run yet. */
static inline size_t finished_in(const char *name)
{
    OWNED(forget) Said s;
    size_t n = 0;
    run(&s, "export @/%s --all --csv -", name);
    for (const char *line = s.code == 0 ? strchr(s.out, '\n') : NULL; line && line[1]; line = strchr(line + 1, '\n')) {
        const char *end = strchr(line + 1, '\n'), *open = strstr(line, ",unfinished,");
        n += !open || (end && open > end);
    }
    return n;
}

#define as_json(...) json_from(output_of(__VA_ARGS__))
static inline json_t *json_from(char *text)
{
    json_error_t error;
    json_t *o = json_loads(text, 0, &error);
    if (!o)
        fail_msg("%s in %s", error.text, text);
    free(text);
    return o;
}

static inline double number(const json_t *o, const char *key)
{
    const json_t *value = json_object_get(o, key);
    if (!json_is_number(value))
        fail_msg("%s is missing or no number", key);
    return json_number_value(value);
}

/* With its folder, where there is none yet. */
static inline void write_in_place(const char *name, const char *text)
{
    FREED char *path = in_place(name), *folder = strndup(path, (size_t)(strrchr(path, '/') - path));
    mkdir(folder, 0777);
    write_to(path, text);
}

/* Storeys of a building in the folder @/name: lines of height, mass and stiffness. */
static inline void write_storeys_in_place(const char *name, const char *rows)
{
    write_in_place(brief("%s/storeys.csv", name), brief("height_m,mass_kg,stiffness_n_m\n%s", rows));
}

static inline int count(const char *text, const char *word)
{
    int n = 0;
    for (; (text = strstr(text, word)); text += strlen(word))
        n++;
    return n;
}

#define has_browser() (system("command -v chromium >/dev/null") == 0)

static inline char *read_in_place(const char *name)
{
    return text_of(there(name));
}

static inline void expect_file(const char *name, const char *words)
{
    FREED char *text = read_in_place(name);
    if (!strstr(text, words))
        fail_msg("%s: %.2000s\n  wanted: %s", name, text, words);
}

static inline void assert_same_files(const char *name, const char *other)
{
    FREED char *a = read_in_place(name), *b = read_in_place(other);
    assert_string_equal(a, b);
}

/* A CSV file with a header, in the test's own folder; released by table_free. */
static inline Table table_of(const char *name)
{
    Table t;
    CHECK_OK(table_read(&t, there(name), 1, &err), &err);
    return t;
}

/* A record of 1.2 s of two sines, under which gaps close at once. */
static inline void write_shaking(const char *name)
{
    char text[4096] = "time_s,accel_m_s2\n";
    for (int i = 0; i <= 60; i++)
        append(text, "%.2f,%.17g\n", 0.02 * i, 3 * sin(2.5 * 0.02 * i) + 2 * sin(8.2 * 0.02 * i));
    write_in_place(name, text);
}

static inline int make_place(void **state)
{
    (void)state;
    snprintf(place.folder, sizeof place.folder, "/tmp/imtet-XXXXXX");
    return getenv("IMTET") && mkdtemp(place.folder) ? 0 : -1;
}

static inline int clear_place(void **state)
{
    (void)state;
    return system(brief("rm -rf '%s'", place.folder));
}

/* As SUITE, of a file whose folder is made before and then filled. */
#define SUITE_FILLED(make, fill, tear_down)                                                                            \
    static int make_filled(void **state)                                                                               \
    {                                                                                                                  \
        if (make(state) != 0)                                                                                          \
            return -1;                                                                                                 \
        fill();                                                                                                        \
        return 0;                                                                                                      \
    }                                                                                                                  \
    SUITE(make_filled, tear_down)

/* Every simulation in a process of its own. */
static const char ISOLATED[] =
    SIX_FLOORS_INI "[sim]\nduration_s = 40\n"
                   "[search]\nmax_evals = 80\npolish = 0\nthreads = 2\nfailures_max = 0\n[run]\nisolate = yes\n";

/* A process that simulates for `parent`, whose helper has started it, gets a signal; 0: none does just now. */
static inline int signal_child_of(pid_t parent, const char *signal)
{
    return system(brief("kill -%s $(pgrep -r R -P $(pgrep -d, -P %d) | tail -1) 2>/dev/null", signal, (int)parent)) ==
           0;
}
