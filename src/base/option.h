/* base/option.h -- what the option structs of the modules share: the room of a text, and types of a few words.
 *
 *   #define SHAPE_LIST(X) X(SHAPE_BOX, "box") X(SHAPE_PLATE, "plate")
 *   typedef enum { SHAPE_LIST(CHOICE_NAME) } Shape;
 *   CHOICE_WORDS(SHAPE_LIST)        "box|plate"
 *
 * so that the constants and the words of a settings file come from one list. */
#pragma once

#include "base/status.h"

enum { OPTION_TEXT_MAX = 512 }; /* bytes, the final zero included */

/* Value of a number for which a word was given ("auto"); below every number that such a setting allows. */
#define OPTION_WORD (-1.0)

/* A comma list of numbers. */
enum { OPTION_LIST_MAX = 128 };
typedef struct {
    int n;                      /* 0: none */
    double at[OPTION_LIST_MAX]; /* (n) */
} NumberList;

/* Number i, the last for those behind the list. */
static inline double list_at(const NumberList *list, int i)
{
    return list->at[i < list->n ? i : list->n - 1];
}

/* Number i of `count` along something: of a list of so many; of two, at the first and the last; of one. */
static inline double list_along(const NumberList *list, int i, int count)
{
    const double share = count > 1 ? (double)i / (count - 1) : 0;
    return list->n == 2 && count != 2 ? list->at[0] + (list->at[1] - list->at[0]) * share : list_at(list, i);
}

/* A path from outside; STATUS_MISSING where there is no room for it. */
Status option_put_path(char option[OPTION_TEXT_MAX], const char *path, Err *err);

#define CHOICE_NAME(name, word) name,
#define CHOICE_WORD(name, word) word,
#define CHOICE_BAR(name, word)  "|" word
#define CHOICE_WORDS(LIST)      (&(LIST(CHOICE_BAR))[1])

#define SWITCH_LIST(X) X(SWITCH_OFF, "off") X(SWITCH_ON, "on")
typedef enum { SWITCH_LIST(CHOICE_NAME) } Switch;
