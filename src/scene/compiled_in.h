/* scene/compiled_in.h -- the files of the built-in buildings, which are part of the program (Makefile, rule for
 * *.csv.o): guyan and appendix as K.csv and M.csv, guyan also as the frame that it is condensed from.
 *
 * Threads  read-only */
#ifndef IMTET_SCENE_COMPILED_IN_H
#define IMTET_SCENE_COMPILED_IN_H

#include <stddef.h>

typedef struct {
    const char *text; /* not closed by a zero; NULL: there is no such file */
    size_t length;
} CompiledIn;

int is_compiled_in(const char *model);

/* file: "nodes.csv" */
CompiledIn compiled_in(const char *model, const char *file);

#endif
