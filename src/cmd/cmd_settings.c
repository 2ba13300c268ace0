#include <errno.h>
#include <limits.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.h"
#include "cmd/commands.h"
#include "cmd/show.h"
#include "settings/settings.h"
#include "store/output.h"

static void put_setting(const char *key, const char *value, void *list)
{
    json_object_set_new(list, key, json_string(value));
}

static Status run(const Args *args, Err *err)
{
    json_t *list = json_object();
    Settings s;
    settings_defaults(&s);
    settings_each(&s, args->operand, put_setting, list);
    if (json_object_size(list) > 0 && args_has(args, "--json"))
        return show_json(list, err);
    const size_t n = json_object_size(list);
    json_decref(list);
    if (n == 0)
        return settings_put(&s, args->operand, "", err);
    if (!args->operand)
        printf("; Every setting of imtet with its default. A setting that is left out of a file keeps this value.\n\n");
    settings_write(&s, stdout, SETTINGS_DESCRIBED, args->operand);
    return STATUS_OK;
}

static const ArgOption OPTIONS[] = {
    SWITCH("--json", "keys and defaults as an object"),
    OPTION_END,
};

const Command CMD_SETTINGS = {
    .name = "settings",
    .group = GROUP_PREPARE,
    .operand = "[KEY|WORD]",
    .summary = "every setting with default, range, unit and meaning",
    .example = "imtet settings motion.pga_g",
    .details = "Prints every setting with its default, preceded by its meaning, unit and range: a valid configuration\n"
               "(imtet settings > mine.ini). KEY or WORD: only those whose name or meaning has it.",
    .options = OPTIONS,
    .run = run,
    .only_reads = 1,
};

static Status begin(const Args *args, Err *err)
{
    static const char NAME[] = "study.ini";
    char path[PATH_MAX], quoted[4 * PATH_MAX + 3];
    Settings s;
    Output o;
    settings_defaults(&s);
    TRY(args_apply(args, &s, NULL, NULL, err));
    TRY(settings_check(&s, err));
    if (snprintf(path, sizeof path, "%s/%s", args->operand, NAME) >= (int)sizeof path)
        return misused(err, "%.60s...: the path is too long", args->operand);
    if (mkdir(args->operand, 0777) != 0 && errno != EEXIST)
        return fail(err, STATUS_IO, "%s: %s", args->operand, strerror(errno));
    if (access(path, F_OK) == 0)
        return misused(err, "%s: is there already; name another folder", path);
    char *folder = realpath(args->operand, NULL), out[PATH_MAX];
    if (!folder)
        return fail(err, STATUS_IO, "%s: %s", args->operand, strerror(errno));
    settings_make_relative(&s, folder);
    snprintf(out, sizeof out, "results%s", strrchr(folder, '/'));
    free(folder);
    if (!args_gives(args, "run.out"))
        TRY(settings_put(&s, "run.out", out, err));
    TRY(output_open(&o, path, err));
    fputs("; What is not written here keeps its default: `imtet settings` lists all.\n\n", o.stream);
    settings_write(&s, o.stream, SETTINGS_BASIC, NULL);
    TRY(output_close(&o, err));
    text_shell(path, quoted);
    printf("%s: edit it, then `imtet check %s` and `imtet optimize %s`\n", path, quoted, quoted);
    return STATUS_OK;
}

static const ArgOption NEW_OPTIONS[] = {OPTION_RECORD, OPTION_PGA, OPTION_SET, OPTION_END};

const Command CMD_NEW = {
    .name = "new",
    .group = GROUP_PREPARE,
    .operand = "FOLDER",
    .summary = "begin a study: a folder with the settings that a first one touches",
    .example = "imtet new tower --set building.model=tower/K-and-M --record tower/kobe.at2 --pga 0.3",
    .details = "Writes FOLDER/study.ini: fifteen settings, each after its meaning, unit and range. Paths in it begin\n"
               "at FOLDER. Its run goes to results/FOLDER.",
    .options = NEW_OPTIONS,
    .run = begin,
    .only_reads = 1,
};
