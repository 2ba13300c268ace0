#include "store/nearest.h"

#include <limits.h>
#include <string.h>
#include <unistd.h>

#include "store/export.h"
#include "store/output.h"

size_t nearest_rows(const Run *run, size_t rows[NEAREST_MAX])
{
    size_t n = 0;
    for (size_t i = 0; i < run->table.n; i++) {
        size_t at = n;
        if (!run->place[i].ok || run->table.row[i].kind == KIND_SCREENED)
            continue;
        while (at > 0 && run->table.row[i].violation < run->table.row[rows[at - 1]].violation)
            at--;
        if (at == NEAREST_MAX)
            continue;
        n += n < NEAREST_MAX;
        memmove(rows + at + 1, rows + at, (n - 1 - at) * sizeof *rows);
        rows[at] = i;
    }
    return n;
}

static void write_row(FILE *f, const Run *run, size_t row)
{
    fprintf(f, "%ld", run->table.row[row].id);
    print_cells(f, 1, &run->table.row[row].violation);
    export_numbers(f, run, row);
    fputc('\n', f);
}

Status nearest_write(const char *folder, const Run *run, size_t n, const size_t rows[], Err *err)
{
    char path[PATH_MAX];
    Output o;
    snprintf(path, sizeof path, "%s/nearest.csv", folder);
    if (n == 0) {
        unlink(path);
        return STATUS_OK;
    }
    TRY(output_open_inside(&o, path, err));
    export_names(o.stream, "id,violation", &run->schema);
    fputc('\n', o.stream);
    for (size_t i = 0; i < n; i++)
        write_row(o.stream, run, rows[i]);
    return output_close(&o, err);
}
