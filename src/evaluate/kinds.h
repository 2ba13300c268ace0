/* evaluate/kinds.h -- which values the variables of a problem have, by problem.kinds: one item for all, or a list.
 *
 *   real                           any number between the bounds
 *   log                            the same, above 0, searched on the scale of its logarithm
 *   int                            a whole number between the bounds
 *   list:4|5|8|10                  one of these numbers, which are in order; its bounds are not read
 *   choice:steel|timber|concrete   one of these words: 0, 1, 2 in the archive, the word wherever people or workers
 *                                  read; its bounds are not read
 *
 * Threads  no state */
#pragma once

#include "evaluate/problem.h"

enum { KIND_WORD_MAX = 64 }; /* bytes of a word */

int kinds_are_real(const char *list); /* every variable is; also where the list is empty */

int kinds_have(const char *list, size_t j, double x); /* variable j may be x: whole, or in its list */

/* kind (n_var), and checks its bounds (2, n_var), the lower ones first; a choice and a list get their own. steps: the
 * numbers of lists, one block to be freed, after a failure too; NULL: there is no list. */
Status kinds_read(const char *list, size_t n_var, VariableKind kind[], double bounds[], Steps **steps, Err *err);

/* The word that a choice has for its number, and back; 0: variable j is no choice or has none such. */
int kinds_word(const char *list, size_t j, double number, char word[KIND_WORD_MAX]);
int kinds_number(const char *list, size_t j, const char *word, double *number);
