/* main.c -- picks the subcommand and turns its status into an exit code.
 *
 * Beside the commands: --help, help [COMMAND], --version [--json]; for `make install` --man [COMMAND], for that and for
 * scripts/completion.bash --commands. */
#include <fcntl.h>
#include <jansson.h>
#include <sys/resource.h>
#include <unistd.h>
#include <wchar.h>

#include "base/linalg.h"
#include "cmd/manual.h"
#include "cmd/show.h"
#include "evaluate/cluster.h"
#include "evaluate/adapter.h"
#include "evaluate/recipe.h"
#include "store/provenance.h"

/* Below this the first deep call would end the program by a fault of its own. */
static const rlim_t STACK_MIN = 256 << 10;

static Status run_command(int argc, char *argv[], Err *err)
{
    const Command *command;
    const char *option;
    struct rlimit stack;
    Args args;
    TRY(command_find(argv[1], &command, &option, err));
    for (int i = 2; option && i < argc; i++) /* `plot --out DIR` is `report --pictures DIR` */
        if (strcmp(argv[i], "--out") == 0 && strcmp(option, "--pictures=pictures") == 0) {
            argv[i] = "--pictures";
            option = NULL;
        }
    const int n_before = option ? 1 : 2; /* the option of an old name stands in the place of that name */
    if (option)
        argv[1] = (char *)(uintptr_t)option;
    if (getrlimit(RLIMIT_STACK, &stack) == 0 && stack.rlim_cur < STACK_MIN)
        return fail(err, STATUS_NO_MEMORY, "the stack is limited to %zu kB (ulimit -s); %zu kB are needed",
                    (size_t)(stack.rlim_cur >> 10), (size_t)(STACK_MIN >> 10));
    TRY(command->only_reads ? STATUS_OK : linalg_room(1, err));
    if (command->only_reads || command->is_alone)
        cluster_disband();
    Status status = args_parse(&args, command, argc - n_before, argv + n_before, err);
    if (status == STATUS_OK && args.help)
        command_help(command, stdout);
    else if (status == STATUS_OK)
        status = command_run(&args, err);
    args_free(&args);
    return status;
}

static int is_help(const char *word)
{
    return asks_for_help(word) || strcmp(word, "help") == 0;
}

/* help and --man: a second word may name a command; more are too many. */
static Status explain(int argc, char *argv[], Err *err)
{
    const Command *command = NULL;
    const char *option;
    if (argc > 3)
        return fail(err, STATUS_USAGE, "imtet %s takes one command at most, found '%.60s'", argv[1], argv[3]);
    if (argc == 3 && !is_help(argv[2]))
        TRY(command_find(argv[2], &command, &option, err));
    if (strcmp(argv[1], "--man") == 0)
        manual_write(command, stdout);
    else if (command)
        command_help(command, stdout);
    else
        usage_write(stdout);
    return STATUS_OK;
}

static Status version(int argc, char *argv[], Err *err)
{
    if (argc > 3 || (argc == 3 && strcmp(argv[2], "--json") != 0))
        return fail(err, STATUS_USAGE, "imtet --version takes nothing but --json");
    if (argc == 3)
        return show_json(program_description(), err);
    printf("imtet %s (%s)\n", program_version(), program_revision());
    return STATUS_OK;
}

static Status run(int argc, char *argv[], Err *err)
{
    if (argc < 2) {
        usage_write(stderr);
        return fail(err, STATUS_USAGE, "no command was given");
    }
    const char *word = argv[1];
    if (is_help(word) || strcmp(word, "--man") == 0)
        return explain(argc, argv, err);
    if (strcmp(word, "--json") == 0 && argc == 3 && strcmp(argv[2], "--version") == 0)
        return show_json(program_description(), err);
    if (strcmp(word, "--version") == 0 || strcasecmp(word, "-v") == 0 || strcmp(word, "version") == 0)
        return version(argc, argv, err);
    if (strcmp(word, "--commands") != 0)
        return run_command(argc, argv, err);
    for (int i = 0; command_at(i); i++)
        puts(command_at(i)->name);
    return STATUS_OK;
}

/* What is put together for JSON is either whole or not there: its many small requests for memory have no error to
 * return, so that one that fails is the end, as by a kill, which every file of a run survives. */
static void *json_memory(size_t size)
{
    void *memory = malloc(size);
    if (memory)
        return memory;
    fprintf(stderr, "imtet: no memory for %zu bytes of JSON\n", size);
    _exit(status_exit_code(STATUS_NO_MEMORY));
}

int main(int argc, char *argv[])
{
    Err err = {0};
    char version[CLUSTER_VERSION_MAX] = "";
    int serves = 0;

    /* 1. A file that is opened in the place of a standard stream that was closed (`imtet ... >&-`) would get what is
     * meant for that. What is open for reading only refuses it, as a closed one does. */
    for (int fd = 0; fd <= 2; fd++)
        if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", O_RDONLY) < 0)
            break;
    json_set_alloc_funcs(json_memory, free);

    /* 2. A rank of a cluster other than the first evaluates for that one and runs no command. */
    Status status = linalg_pin() ? STATUS_OK : fail(&err, STATUS_NO_MEMORY, "no memory to begin with");
    if (status == STATUS_OK) {
        program_identity(sizeof version, version);
        status = cluster_join(&argc, &argv, version, simulator_open, &serves, &err);
    }
    if (!serves)
        THEN(status, run(argc, argv, &err));
    if ((fflush(stdout) != 0 || ferror(stdout)) && status == STATUS_OK)
        status = fail(&err, STATUS_IO, "standard output: cannot be written");

    /* 3. A failure is a sentence on standard error, and with --json also an object on standard output, unless there is
     * one already: a stream that was never written to has no orientation. */
    const char *words = err.text[0] ? err.text : status_words(status);
    if (status != STATUS_OK)
        fprintf(stderr, "imtet: %s\n", words);
    for (int i = 1; i < argc && status != STATUS_OK; i++)
        if (strcmp(argv[i], "--json") == 0 && fwide(stdout, 0) == 0)
            show_json(json_of("error=%s status=%ld", words, (long)status_exit_code(status)), &(Err){0});
    cluster_leave(status_exit_code(status));
    return status_exit_code(status);
}
