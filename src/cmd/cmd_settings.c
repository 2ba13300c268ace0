#include "cmd/commands.h"
#include "settings/settings.h"

static Status run(const Args *args, Err *err)
{
    (void)args;
    (void)err;
    Settings s;
    settings_defaults(&s);
    printf("; Every setting of imtet with its default. A setting that is left out of a file keeps this value.\n\n");
    settings_write(&s, stdout, 1);
    return STATUS_OK;
}

static const ArgOption OPTIONS[] = {OPTION_END};

const Command CMD_SETTINGS = {
    .name = "settings",
    .group = GROUP_PREPARE,
    .summary = "every setting with default, range, unit and meaning",
    .example = "imtet settings > mine.ini",
    .details = "Prints every setting with its default, preceded by its meaning, unit and range: a valid configuration.",
    .options = OPTIONS,
    .run = run,
    .only_reads = 1,
};
