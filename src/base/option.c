#include "base/option.h"

Status option_put_path(char option[OPTION_TEXT_MAX], const char *path, Err *err)
{
    return snprintf(option, OPTION_TEXT_MAX, "%s", path) < OPTION_TEXT_MAX
               ? STATUS_OK
               : fail(err, STATUS_MISSING, "%.60s...: the path is too long", path);
}
