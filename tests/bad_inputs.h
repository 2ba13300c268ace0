/* tests/bad_inputs.h -- folders of inputs that are each wrong in one way. The first line of every file says what the
 * message must hold: "; wants: TEXT" or "# wants: TEXT". */
#pragma once

#include "check.h"

#include <dirent.h>

typedef Status (*ReadFn)(const char *path, Err *err);

static inline void read_wanted(const char *path, char wanted[256])
{
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    assert_int_equal(fscanf(f, "%*c wants: %255[^\n]", wanted), 1);
    fclose(f);
}

/* Every file of the folder is refused as bad data with its own message, which names the file. Returns their number. */
static inline int all_refused(const char *folder, ReadFn read)
{
    char path[512], wanted[256];
    int n = 0;
    DIR *d = opendir(folder);
    assert_non_null(d);
    for (struct dirent *e; (e = readdir(d));) {
        if (e->d_name[0] == '.')
            continue;
        err = (Err){0};
        snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
        read_wanted(path, wanted);
        const Status status = read(path, &err);
        if (status != STATUS_BAD_DATA || !strstr(err.text, wanted) || !strstr(err.text, path)) {
            print_error("%s: status %d, message '%s', wanted '%s'\n", path, (int)status, err.text, wanted);
            fail_msg("%s", path);
        }
        n++;
    }
    closedir(d);
    return n;
}
