/* cmd/document.h -- what a command has to say, said once; one layer prints it as text, CSV, JSON and HTML.
 *
 *   part     a heading, a paragraph, a table, a list of figures or a drawing of the page, in the order of their coming
 *   table    a JSON array of rows; a row is an object, a column a key of it, in the order in which the rows bring them
 *   cell     text, a whole number, a number, a figure (a number with what is not known of it), or none (null, left out)
 *
 *   text     paragraphs wrapped to the terminal, tables aligned below their names, in as many bands as it takes; four
 *            digits, or those that are known
 *   HTML     the same; a column or a row that a measure names (evaluate/measures.h) has its title and unit. The one
 *            place where words come into a page: all of them are escaped
 *   CSV      `rows`, with all digits; `summaries` of them into FILE-fractiles.csv
 *   JSON     `data`
 *   drawing  `drawing`, one of DRAWINGS of web/app/8-paper.js
 *
 * Ownership  json_t that are given are taken over; document_give and document_print release all of it,
 *            after which the Document is empty */
#pragma once

#include "base/json.h"
#include "cmd/args.h"
#include "sim/result.h"

typedef struct {
    json_t *parts, *rows, *summaries, *data, *drawn; /* drawn: data of the drawing; NULL: those of JSON */
    const char *drawing;
    int width; /* [px] */
} Document;

/* Words: a paragraph, or what `element` says, h1, h2, li, code of HTML, "note": a paragraph in small. Every line
 * becomes one, an empty one none. */
__attribute__((format(printf, 3, 4))) void document_add(Document *d, const char *element, const char *format, ...);
#define document_say(d, ...) document_add(d, "p", __VA_ARGS__)

json_t *document_table(Document *d);        /* an empty one, borrowed; without rows it is not shown */
void document_list(Document *d, json_t *o); /* a line for every member that is neither empty nor rows */
void document_draw(Document *d, const char *name, const char *caption); /* DRAWINGS of web/app/8-paper.js; HTML alone */

/* Writes what the options ask for, --csv, --svg, --json, and the text if standard output is free. */
Status document_give(Document *d, const Args *args, Err *err);
void document_print(Document *d, FILE *out, int is_html);
void document_free(Document *d);

/* Help: an example, the details and every option, wrapped to the terminal. */
void command_help(const Command *command, FILE *out);

int terminal_width(int fd); /* COLUMNS where it is set; INT_MAX: no terminal */

/* ---- rows -------------------------------------------------------------------------------------------------------- */

json_t *json_only(json_t *list);                           /* a list of one is its item */
json_t *json_plain(const json_t *rows);                    /* a copy: of figures the values alone */
json_t *json_column(const json_t *rows, const char *name); /* its cells; NULL: the first row has none */

json_t *figures_row(json_t *table); /* a further one */

/* A figure (base/figure.h). error: the likely one; sd: standard deviation; NAN: not known. word: in the place of "sd";
 * "(": "value (error to sd)". */
void figures_put(json_t *row, const char *column, double value, double error, double sd);
#define figures_number(row, column, value) figures_put(row, column, value, NAN, NAN)
void figures_put_as(json_t *row, const char *column, double value, double error, double sd, const char *word);

Status rows_write(json_t *table, const char *path, Err *err); /* as CSV */
Status show_json(json_t *all, Err *err);
