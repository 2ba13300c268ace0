/* store/logs.h -- what happened when: log.txt for people, log.jsonl for programs.
 *
 * Threads  one at a time.   Errors  STATUS_IO with file and cause; logs that are not open take nothing */
#ifndef IMTET_STORE_LOGS_H
#define IMTET_STORE_LOGS_H

#include <jansson.h>
#include <stdarg.h>

#include "store/folder.h"

typedef struct {
    Append text, events;
} Logs;

Status logs_open(Logs *logs, const Folder *folder, Err *err);

/* One line, the local time in front. */
Status logs_say(Logs *logs, const char *format, va_list args, Err *err);

/* One object, "time" (UTC) added; takes it over. No memory for it: it is left out. */
Status logs_event(Logs *logs, json_t *event, Err *err);

Status logs_close(Logs *logs, Err *err);
void logs_free(Logs *logs);

/* 2026-01-31T23:59:59Z, now */
void utc_now(char text[24]);

#endif
