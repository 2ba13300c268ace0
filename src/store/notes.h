/* store/notes.h -- what people say of designs: RUN/notes.json, {"417": "for the client", ...}, "0" of the run itself,
 * beside the run and never read by a search. It may be edited by hand.
 *
 * Ownership  the caller's reference
 * Threads    one writer at a time; a reader finds the notes of before or after
 * Errors     a file that is none: STATUS_BAD_DATA; not to be written: STATUS_IO */
#pragma once

#include <jansson.h>

#include "store/run.h"

enum { NOTE_BYTES_MAX = 4000 };

/* No file, no notes: an empty object. */
Status notes_read(const char *folder, json_t **notes, Err *err);

/* Notes on designs that the run has: also where the file is none, or names other designs, which is an error. */
Status notes_of_run(const Run *run, json_t **notes, Err *err);

/* text: at most NOTE_BYTES_MAX bytes; empty takes the note away. */
Status notes_put(const char *folder, long id, const char *text, Err *err);
