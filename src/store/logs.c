#include "store/logs.h"

#include <time.h>

void utc_now(char text[24])
{
    struct tm parts;
    const time_t now = time(NULL);
    gmtime_r(&now, &parts);
    strftime(text, 24, "%FT%TZ", &parts);
}

Status logs_open(Logs *logs, const Folder *folder, Err *err)
{
    TRY(append_open(&logs->text, folder, "log.txt", err));
    return append_open(&logs->events, folder, "log.jsonl", err);
}

Status logs_say(Logs *logs, const char *format, va_list args, Err *err)
{
    char clock[32];
    struct tm parts;
    const time_t now = time(NULL);
    FILE *f = logs->text.stream;
    if (!f)
        return STATUS_OK;
    localtime_r(&now, &parts);
    strftime(clock, sizeof clock, "%F %T", &parts);
    fprintf(f, "%s  ", clock);
    vfprintf(f, format, args);
    fputc('\n', f);
    return append_flush(&logs->text, err);
}

Status logs_event(Logs *logs, json_t *event, Err *err)
{
    char time[24];
    FILE *f = logs->events.stream;
    utc_now(time);
    json_object_set_new(event, "time", json_string(time));
    if (f && json_dumpf(event, f, JSON_SORT_KEYS) == 0)
        fputc('\n', f);
    json_decref(event);
    return f ? append_flush(&logs->events, err) : STATUS_OK;
}

Status logs_close(Logs *logs, Err *err)
{
    TRY(append_close(&logs->events, err));
    return append_close(&logs->text, err);
}

void logs_free(Logs *logs)
{
    append_free(&logs->text);
    append_free(&logs->events);
}
