/* report/words.h -- how pages call an objective of any problem (of a measure: evaluate/measures.h), and a rule.
 *
 * Threads  pure functions; texts live as long as the program, or as the schema */
#pragma once

#include "evaluate/schema.h"

/* Words for objective k, or for measure k - n_obj; other problems than the tower have names without units. */
Words words_of_objective(const Schema *schema, size_t k);

/* Says what an objective of several simulations is, "worst of 2 records x 4 replicates"; else empty. */
enum { RULE_WORDS_MAX = 120 };
void words_of_rule(const Settings *s, char text[RULE_WORDS_MAX]);
