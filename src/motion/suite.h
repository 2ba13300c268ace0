/* motion/suite.h -- the records of a study: motion.record, then those of motion.records.
 *
 *   source   PATH | builtin:NAME, then [channel=NAME] [factor=NUMBER] [rate=NUMBER]: the component of a file that has
 *            several, what its acceleration is multiplied by (beside motion.factor; with no other scaling), and for
 *            how many events of a year it stands (measure annual_loss)
 *   suite    a folder (every file of it by name; folders inside and hidden files are left out), a file whose name ends
 *            in list.txt (a source on each line, paths from its folder; # begins a comment), or builtin:suite
 *            (motion/synthetic.h)
 *
 * An item of motion.records is a source or a suite; what a suite has of motion.record itself does not count again.
 *
 * Errors   STATUS_BAD_DATA, and what `take` says of a line of a list, name file and line; STATUS_MISSING: no such
 *          folder or list
 * Threads  no state */
#pragma once

#include "motion/options.h"

typedef struct {
    char path[OPTION_TEXT_MAX]; /* or builtin:NAME */
    char channel[64];           /* empty: not said */
    double factor;              /* 1: not said */
    double rate;                /* [1/year] 0: not said */
} Source;
Status source_read(const char *text, Source *out, Err *err);

/* Where the words behind the path begin. */
size_t source_path_length(const char *text);

typedef Status SourceFn(const char *source, void *user, Err *err);

/* Is it one, and then its sources; else the item itself is a source. */
Status suite_each(const char *item, SourceFn take, void *user, Err *err);

/* Of the study, motion.record first. */
Status suite_of_study(const MotionOptions *o, SourceFn take, void *user, Err *err);
Status suite_size(const MotionOptions *o, size_t *n, Err *err); /* how many */
size_t suite_count(const MotionOptions *o); /* 1 where they cannot be read, of which opening them says why */
