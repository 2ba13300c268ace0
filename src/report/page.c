
#include "base/text.h"
#include "report/report.h"
#include "report/report_json.h"
#include "store/export.h"
#include "store/output.h"

static const size_t NOT_TAKEN = SIZE_MAX;

static double value_of(const Run *run, size_t row, size_t column)
{
    const size_t n_obj = run->schema.n_obj;
    return column < n_obj ? run_f(run, row)[column] : run_x(run, row)[column - n_obj];
}

/* Into rows (n_front), which hold NOT_TAKEN for the other designs of the front: the lowest and the highest value of
 * every column, polished designs, and those that are to be kept. */
static void take_wanted(const Run *run, const size_t kept[2], size_t rows[])
{
    const size_t n = run->n_front, *front = run->front;
    for (size_t i = 0; i < n; i++) {
        const int is_polished = run->table.row[front[i]].kind == KIND_POLISHED;
        rows[i] = is_polished || front[i] == kept[0] || front[i] == kept[1] ? front[i] : NOT_TAKEN;
    }
    for (size_t column = 0; column < run->schema.n_obj + run->schema.n_var; column++) {
        size_t low = 0, high = 0;
        for (size_t i = 1; i < n; i++) {
            const double v = value_of(run, front[i], column);
            low = v < value_of(run, front[low], column) ? i : low;
            high = v > value_of(run, front[high], column) ? i : high;
        }
        rows[low] = front[low];
        rows[high] = front[high];
    }
}

size_t thin_front(const Run *run, size_t most, const size_t kept[2], size_t rows[])
{
    const size_t n = run->n_front;
    size_t wanted = 0, taken = 0;
    if (n <= most) {
        memcpy(rows, run->front, n * sizeof *rows);
        return n;
    }
    take_wanted(run, kept, rows);
    for (size_t i = 0; i < n; i++)
        wanted += rows[i] != NOT_TAKEN;
    for (size_t k = wanted; k < most; k++) {
        const size_t i = (k - wanted) * n / (most - wanted);
        rows[i] = run->front[i];
    }
    for (size_t i = 0; i < n; i++)
        if (rows[i] != NOT_TAKEN)
            rows[taken++] = rows[i];
    return taken;
}

/* build/web/page.html, live.html: the page with a line MARK where the run goes. */
extern const char _binary_build_web_page_html_start[], _binary_build_web_page_html_end[];
extern const char _binary_build_web_live_html_start[], _binary_build_web_live_html_end[];
static const char MARK[] = "<!-- the run -->\n";

/* JSON in which no text can end the script element or begin a comment: < stands only inside strings. */
static void write_json(json_t *all, FILE *out)
{
    char *text = json_dumps(all, JSON_COMPACT | JSON_ENSURE_ASCII | JSON_REAL_PRECISION(6));
    json_decref(all);
    for (const char *p = text; *p; p++)
        if (*p == '<')
            fputs("\\u003c", out);
        else
            fputc(*p, out);
    free(text);
}

static Status write_page(const Report *r, const char *start, const char *end, FILE *out, Err *err)
{
    const char *mark = memmem(start, end - start, MARK, sizeof MARK - 1);
    if (!mark)
        return fail(err, STATUS_INTERNAL, "the page of the report has no place for the run");
    fwrite(start, 1, mark - start, out); /* a failed write is seen on closing */
    fputs("<script type=\"application/json\" id=\"run\">", out);
    write_json(report_json(r), out);
    fputs("</script>\n<script type=\"text/plain\" id=\"rows\">\n", out);
    TRY(export_designs(out, r->run, EXPORT_PAGE, r->n_shown, r->shown, err));
    fputs("</script>\n", out);
    mark += sizeof MARK - 1;
    fwrite(mark, 1, end - mark, out);
    return STATUS_OK;
}

static Status write_whole(const Report *r, const char *path, Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    const Status status =
        write_page(r, _binary_build_web_page_html_start, _binary_build_web_page_html_end, o.stream, err);
    return output_end(&o, status, err);
}

Status report_page(const Report *r, const char *path, Err *err)
{
    Report whole = *r;
    TRY_ROOM(whole.shown, r->run->n_front, "designs", err);
    whole.n_shown = thin_front(r->run, REPORT_DESIGNS_MAX, (size_t[]){r->knee, r->chosen}, whole.shown);
    Status status = importance_of(r->run, &whole.importance, err);
    if (status == STATUS_OK)
        status = write_whole(&whole, path, err);
    importance_free(&whole.importance);
    free(whole.shown);
    return status;
}

Status report_live(const Run *run, char **text, Err *err)
{
    size_t length;
    Report r = report_brief(run);
    *text = NULL;
    if (run->n_front == 0)
        return run_why_empty(run, err);
    FILE *out = text_open(text, &length);
    if (!out)
        return fail_memory(err, 1, "a page");
    r.knee = r.chosen = run_knee(run);
    r.n_shown = run->n_front;
    r.shown = run->front;
    Status status = write_page(&r, _binary_build_web_live_html_start, _binary_build_web_live_html_end, out, err);
    if (text_close(out) && status == STATUS_OK)
        status = fail_memory(err, 1, "a page");
    if (status != STATUS_OK) {
        free(*text);
        *text = NULL;
    }
    return status;
}
