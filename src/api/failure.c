#include "api/failure.h"

#include "settings/settings.h"

_Static_assert((int)IMTET_STOPPED == (int)STATUS_STOPPED && (int)STATUS_STOPPED + 1 == (int)STATUS_COUNT,
               "the statuses of the library are those of its header");

const char *imtet_version(void)
{
    return IMTET_VERSION;
}

imtet_status api_status(Status status, const Err *err, imtet_error *error)
{
    if (error) {
        error->status = (imtet_status)status;
        text_copy(error->text, status == err->code ? err->text : "");
    }
    return (imtet_status)status;
}

Status api_check_finite(const char *what, size_t n, const double x[], const char *cure, Err *err)
{
    for (size_t i = 0; i < n; i++)
        if (!isfinite(x[i]))
            return bad_data(err, "%s: number %zu is %g; %s", what, i + 1, x[i], cure);
    return STATUS_OK;
}

Status api_settings(Settings *s, const char *const list[], Err *err)
{
    for (size_t i = 0; list && list[i]; i++)
        TRY(settings_set(s, list[i], err));
    return STATUS_OK;
}
