/* main.c -- picks the subcommand and turns its status into an exit code. */
#include <cblas.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cmd/commands.h"
#include "run/provenance.h"

#define X(name) &CMD_##name,
static const Command *const COMMANDS[] = {COMMAND_LIST(X)};
#undef X
enum { N_COMMANDS = sizeof COMMANDS / sizeof COMMANDS[0] };

static void print_usage(FILE *out)
{
    fprintf(out,
            "example: %s\n\nEarthquake protection by impacts between a tower and an inner core.\n\n"
            "usage: imtet COMMAND ...\n\n",
            CMD_OPTIMIZE.example);
    for (int i = 0; i < N_COMMANDS; i++)
        fprintf(out, "  %-9s %-7s %s\n", COMMANDS[i]->name, COMMANDS[i]->operand ? COMMANDS[i]->operand : "",
                COMMANDS[i]->summary);
    fprintf(out, "\n`imtet COMMAND --help` shows an example and every option. Exit status: 0 done, 2 command line not\n"
                 "understood, 65 bad data or settings, 66 input missing, 70 program failed, 74 output not written.\n");
}

static Status find_command(const char *word, const Command **found, Err *err)
{
    const char *names[N_COMMANDS];
    for (int i = 0; i < N_COMMANDS; i++) {
        names[i] = COMMANDS[i]->name;
        *found = COMMANDS[i];
        if (strcmp(word, names[i]) == 0)
            return STATUS_OK;
    }
    return args_unknown(word[0] == '-' ? "option" : "command", word, names, N_COMMANDS, "`imtet --help`", err);
}

static Status run_command(int argc, char *argv[], Err *err)
{
    const Command *command;
    Args args;
    TRY(find_command(argv[1], &command, err));
    Status status = args_parse(&args, command, argc - 2, argv + 2, err);
    if (status == STATUS_OK && args.help)
        command_help(command, stdout);
    else if (status == STATUS_OK)
        status = command->run(&args, err);
    args_free(&args);
    return status;
}

static Status run(int argc, char *argv[], Err *err)
{
    if (argc < 2) {
        print_usage(stderr);
        return fail(err, STATUS_USAGE, "no command was given");
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0)
        print_usage(stdout);
    else if (strcmp(argv[1], "--version") == 0)
        printf("imtet %s (%s)\n", program_version(), program_revision());
    else
        return run_command(argc, argv, err);
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
    json_set_alloc_funcs(json_memory, free);
    openblas_set_num_threads(1); /* simulations run side by side; threads below them would fight for the processors */
    Status status = run(argc, argv, &err);
    if ((fflush(stdout) != 0 || ferror(stdout)) && status == STATUS_OK)
        status = fail(&err, STATUS_IO, "standard output: cannot be written");
    if (status != STATUS_OK)
        fprintf(stderr, "imtet: %s\n", err.text[0] ? err.text : status_words(status));
    return status_exit_code(status);
}
