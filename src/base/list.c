#include "base/list.h"

#include <stdio.h>
#include <string.h>

#include "base/text.h"

int list_item(const char *list, size_t i, char item[], size_t size)
{
    for (; list && i > 0; i--) {
        list = strchr(list, ',');
        list = list ? list + 1 : NULL;
    }
    if (!list)
        return 0;
    list += strspn(list, " \t");
    size_t n = strcspn(list, ",");
    while (n > 0 && (list[n - 1] == ' ' || list[n - 1] == '\t'))
        n--;
    return n > 0 && (size_t)snprintf(item, size, "%.*s", (int)n, list) < size;
}

size_t list_count(const char *list)
{
    size_t n = 1;
    for (; *list; list++)
        n += *list == ',';
    return n;
}

void list_change(char list[LIST_MAX], ListItemFn change, void *user)
{
    char item[LIST_MAX], all[LIST_MAX + 1] = "";
    for (size_t i = 0; i < list_count(list); i++) {
        if (!list_item(list, i, item, sizeof item))
            return;
        change(item, user);
        text_join(all, sizeof all, ",", "%s", item);
    }
    if (strlen(all) < LIST_MAX)
        memcpy(list, all, strlen(all) + 1);
}

int list_is_given(const char *list)
{
    return list[0] && strcmp(list, "none") != 0;
}
