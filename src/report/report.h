/* report/report.h -- a finished run as something to look at: one HTML page, or pictures for a paper.
 *
 *   page       web/page.html with style, charts and script inside; the run goes in as JSON and as rows of numbers. No
 *              network, no eval: the page's own policy allows nothing but these very scripts, by their hashes
 *              It simulates designs itself where it has a scene (src/wasm/engine.c)
 *   pictures   its charts as SVG and PNG, drawn by Chromium (report/pictures.h)
 *
 * A run of another problem than the tower has no Detail, and its page and pictures no part on a chosen design.
 *
 * Life cycle  report_open -> report_page, report_pictures -> report_close      (a zeroed Report may be closed)
 * Ownership   the run is borrowed and only read; its chosen design is simulated again */
#pragma once

#include "report/detail.h"
#include "report/importance.h"
#include "report/what_if.h"

typedef struct {
    const Run *run;
    size_t knee, chosen; /* rows of the run */
    int is_robust;       /* objectives are those of several simulations, not of the one in detail */
    int has_detail;
    Detail detail;
    Importance importance;  /* report_page finds it; elsewhere empty */
    json_t *scene;          /* report/what_if.h, with which the page simulates; NULL: it does not */
    size_t n_shown, *shown; /* rows of the designs of the front that the page has (thin_front); as the importance */
} Report;

/* chosen: row of the run, on its front or not; the front may not be empty (run_why_empty). */
Status report_open(Report *r, const Run *run, size_t chosen, const DetailOptions *options, Err *err);

/* At most REPORT_DESIGNS_MAX designs of the front and what thin_front keeps beyond them: more are too many to be
 * drawn. */
enum { REPORT_DESIGNS_MAX = 10000 };
Status report_page(const Report *r, const char *path, Err *err);

/* A run before anything of it is simulated again: no design in detail. */
Report report_brief(const Run *run);

/* The page of such a report for `imtet serve`, whose live parts ask for designs in detail; text: to be freed. */
Status report_live(const Run *run, char **text, Err *err);

/* Pictures FOLDER/NAME.svg and .png, the folder made where it is not there. */
Status report_pictures(const Report *r, const char *folder, Err *err);
void report_close(Report *r);

/* Which designs of a very large front a page shows.
 *
 * All of a front that has no more than `most`. Else those with the lowest and the highest value of every objective and
 * variable, the designs that are to be kept, polished ones, and the others evenly in the order of their evaluation:
 * ranges stay as they are, and where the front is dense there is more of it. */
/* Rows of the run, ascending, into rows (n_front); returns how many: `most`, and what has to be kept beyond that.
 * kept: rows of the run, on its front or not. */
size_t thin_front(const Run *run, size_t most, const size_t kept[2], size_t rows[]);
