
#include <float.h>

#include "base/text.h"
#include "report/pictures.h"
#include "report/report_json.h"
#include "store/export.h"
#include "store/output.h"

static const size_t NOT_TAKEN = SIZE_MAX;

static double value_of(const Run *run, size_t row, size_t column)
{
    const size_t n_obj = run->schema.n_obj;
    return column < n_obj ? run_f(run, row)[column] : run_x(run, row)[column - n_obj];
}

size_t thin_front(const Run *run, size_t most, const size_t kept[2], size_t rows[])
{
    const size_t n = run->n_front, *front = run->front;
    size_t wanted = 0, taken = 0;
    if (n <= most) {
        memcpy(rows, front, n * sizeof *rows);
        return n;
    }

    /* 1. Polished designs and those that are to be kept, then the lowest and the highest value of every column; the
     * others of the front are NOT_TAKEN so far. */
    for (size_t i = 0; i < n; i++) {
        const int is_polished = kind_is_outside(run->table.row[front[i]].kind);
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

    /* 2. The rest evenly. */
    for (size_t i = 0; i < n; i++)
        wanted += rows[i] != NOT_TAKEN;
    for (size_t k = wanted; k < most; k++) {
        const size_t i = (k - wanted) * n / (most - wanted);
        rows[i] = front[i];
    }
    for (size_t i = 0; i < n; i++)
        if (rows[i] != NOT_TAKEN)
            rows[taken++] = rows[i];
    return taken;
}

/* build/web/page.html, live.html: the page with a line for its parts, one for the run, and two about the engine. */
extern const char _binary_build_web_page_html_start[], _binary_build_web_page_html_end[];
extern const char _binary_build_web_live_html_start[], _binary_build_web_live_html_end[];

/* JSON in which no text can end the script element or begin a comment: < stands only inside strings. */
static void write_part(const char *id, json_t *part, int digits, FILE *out)
{
    char *text = json_dumps(part, JSON_COMPACT | JSON_ENSURE_ASCII | JSON_REAL_PRECISION(digits));
    json_decref(part);
    fprintf(out, "<script type=\"application/json\" id=\"%s\">", id);
    for (const char *p = text; *p; p++)
        if (*p == '<')
            fputs("\\u003c", out);
        else
            fputc(*p, out);
    free(text);
    fputs("</script>\n", out);
}

/* A page of its template. body NULL: the parts of a report, which simulates with its scene, or if it is live with what
 * the server sends. */
static Status write_page(json_t *run, const Report *rows, const char *body, int is_live, FILE *out, Err *err)
{
    const char *const start = is_live ? _binary_build_web_live_html_start : _binary_build_web_page_html_start;
    const char *const end = is_live ? _binary_build_web_live_html_end : _binary_build_web_page_html_end;
    json_t *scene = body ? NULL : rows->scene;
    static const char *const MARKS[] = {"<!-- the parts -->\n", "<!-- the run -->\n", "<!-- the engine -->\n",
                                        "<!-- the scene -->\n"};
    enum { PARTS, RUN, ENGINE, SCENE, N_MARKS };
    const char *at[N_MARKS], *behind[N_MARKS];
    for (int i = 0; i < N_MARKS; i++) {
        at[i] = memmem(start, end - start, MARKS[i], strlen(MARKS[i]));
        if (!at[i]) {
            json_decref(run);
            return fail(err, STATUS_INTERNAL, "the page of the report has no '%.20s'", MARKS[i]);
        }
        behind[i] = at[i] + strlen(MARKS[i]);
    }

    /* A failed write is seen on closing. */
    fwrite(start, 1, (body ? at[PARTS] : at[RUN]) - start, out);
    fputs(body ? body : "", out);
    write_part("run", run, 6, out);
    if (rows)
        write_part("kept-designs", kept_json(rows), DBL_DECIMAL_DIG, out);
    fputs("<script type=\"text/plain\" id=\"rows\">\n", out);
    const Status status =
        rows ? export_designs(out, rows->run, EXPORT_PAGE, rows->n_shown, rows->shown, err) : STATUS_OK;
    fputs("</script>\n", out);
    fwrite(behind[RUN], 1, at[ENGINE] - behind[RUN], out);
    if (is_live || scene)
        fwrite(behind[ENGINE], 1, at[SCENE] - behind[ENGINE], out);
    if (scene)
        write_part("scene", json_incref(scene), 6, out);
    fwrite(behind[SCENE], 1, end - behind[SCENE], out);
    return status;
}

Status page_write(FILE *out, json_t *run, const Report *rows, const char *body, Err *err)
{
    return write_page(run, rows, body, 0, out, err);
}

static Status write_whole(const Report *r, const char *path, Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    return output_end(&o, write_page(report_json(r), r, NULL, 0, o.stream, err), err);
}

/* The report with the designs that a page shows, which become a page or pictures at path. */
static Status with_shown(Report r, Status (*make)(const Report *, const char *, Err *), const char *path, Err *err)
{
    TRY_ROOM(r.shown, r.run->n_front, "designs", err);
    r.n_shown = thin_front(r.run, REPORT_DESIGNS_MAX, (size_t[]){r.knee, r.chosen}, r.shown);
    const Status status = make(&r, path, err);
    free(r.shown);
    return status;
}

Status report_page(const Report *r, const char *path, Err *err)
{
    Report whole = *r;
    Status status = importance_of(r->run, &whole.importance, err);
    THEN(status, with_shown(whole, write_whole, path, err));
    importance_free(&whole.importance);
    return status;
}

Status report_pictures(const Report *r, const char *folder, Err *err)
{
    return with_shown(*r, pictures_of, folder, err);
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
    Status status = write_page(report_json(&r), &r, NULL, 1, out, err);
    if (text_close(out) && status == STATUS_OK)
        status = fail_memory(err, 1, "a page");
    if (status != STATUS_OK) {
        free(*text);
        *text = NULL;
    }
    return status;
}
