/* base/list.h -- comma lists: "a, b, c" has three items, without the blanks around them.
 *
 * Threads  no state */
#pragma once

#include <stddef.h>

enum { LIST_MAX = 512 }; /* bytes of a list that is changed */

/* Item i; 0 where there is none or it does not fit. */
int list_item(const char *list, size_t i, char item[], size_t size);
size_t list_count(const char *list);
int list_is_given(const char *list); /* it is not empty, nor the word none */

/* Every item handed to `change`, which may write another one. The list stays as it is where an item is empty or the
 * result has no room. */
typedef void (*ListItemFn)(char item[LIST_MAX], void *user);
void list_change(char list[LIST_MAX], ListItemFn change, void *user);
