#include "cmd/document.h"

#include <limits.h>
#include <stdarg.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "base/figure.h"
#include "base/text.h"
#include "base/visible.h"
#include "cmd/outputs.h"
#include "evaluate/measures.h"
#include "report/pictures.h"
#include "store/output.h"
#include "study/progress.h"

enum { CELL_MAX = 600, LISTED_MAX = 32 /* numbers in a line: more are not for the eye */ };

/* ---- parts ------------------------------------------------------------------------------------------------------- */

/* {kind: content}, taken over. */
static void add(Document *d, const char *kind, json_t *content)
{
    json_t *part = json_object();
    json_object_set_new(part, kind, content);
    d->parts = d->parts ? d->parts : json_array();
    json_array_append_new(d->parts, part);
}

void document_free(Document *d)
{
    json_decref(d->parts);
    json_decref(d->rows);
    json_decref(d->summaries);
    json_decref(d->data);
    json_decref(d->drawn);
    *d = (Document){0};
}

void document_add(Document *d, const char *element, const char *format, ...)
{
    va_list list;
    char *words = NULL, *line, *rest;
    va_start(list, format);
    if (vasprintf(&words, format, list) < 0)
        words = NULL;
    for (rest = words; (line = strsep(&rest, "\n"));)
        if (*line)
            add(d, element, json_words(line));
    va_end(list);
    free(words);
}

json_t *document_table(Document *d)
{
    json_t *table = json_array();
    add(d, "table", table);
    return table;
}

void document_draw(Document *d, const char *name, const char *caption)
{
    add(d, "figure", json_pack("[ss]", name, caption));
}

json_t *json_only(json_t *list)
{
    json_t *item = json_array_size(list) == 1 ? json_incref(json_array_get(list, 0)) : NULL;
    if (item)
        json_decref(list);
    return item ? item : list;
}

json_t *json_plain(const json_t *rows)
{
    json_t *copy = json_deep_copy(rows), *row, *cell;
    const char *name;
    size_t i;
    json_array_foreach(copy, i, row) json_object_foreach(row, name, cell) if (json_is_array(cell))
        json_object_set(row, name, json_array_get(cell, 0));
    return copy;
}

json_t *json_column(const json_t *rows, const char *name)
{
    json_t *list = json_object_get(json_array_get(rows, 0), name) ? json_array() : NULL, *row;
    size_t i;
    json_array_foreach(rows, i, row) json_array_append(list, json_object_get(row, name));
    return list;
}

json_t *figures_row(json_t *table)
{
    json_t *row = json_object();
    json_array_append_new(table, row);
    return row;
}

void figures_put_as(json_t *row, const char *column, double value, double error, double sd, const char *word)
{
    json_object_set_new(row, column,
                        json_pack("[ooos]", json_number(value), json_number(error), json_number(sd), word));
}

void figures_put(json_t *row, const char *column, double value, double error, double sd)
{
    figures_put_as(row, column, value, error, sd, "sd");
}

/* ---- cells ------------------------------------------------------------------------------------------------------- */

static double number_of(const json_t *cell)
{
    return json_is_number(cell) ? json_number_value(cell) : NAN;
}

/* As it is shown, times factor; NULL: empty. Of a number that is known zeros behind the point go: 0.03, not 0.03000. */
static void cell_words(const char *column, const json_t *cell, double factor, char text[CELL_MAX])
{
    static const double NOTHING = 0.05; /* [%] of a share, which is not negative but by rounding or a deviation */
    const char *word = json_string_value(json_array_get(cell, 3));
    double v[3];
    char figure[3][FIGURE_MAX];
    for (int i = 0; i < 3; i++) {
        v[i] = factor * number_of(json_is_array(cell) ? json_array_get(cell, i) : cell);
        figure_text(v[i], word ? NAN : 0, NAN, "", figure[i]);
    }
    if (!cell || json_is_string(cell))
        snprintf(text, CELL_MAX, "%s", cell ? json_string_value(cell) : "");
    else if (json_is_integer(cell))
        snprintf(text, CELL_MAX, "%" JSON_INTEGER_FORMAT, json_integer_value(cell));
    else if (json_is_boolean(cell))
        snprintf(text, CELL_MAX, "%s", json_is_true(cell) ? "yes" : "no");
    else if (word && strstr(column, "_pct") && v[0] < 0 && v[0] > -NOTHING && isnan(v[1]) && isnan(v[2]))
        snprintf(text, CELL_MAX, "0.0");
    else if (word && word[0] == '(')
        snprintf(text, CELL_MAX, "%s (%s to %s)", figure[0], figure[1], figure[2]);
    else if (word)
        figure_text(v[0], v[1], v[2], word, text);
    else
        snprintf(text, CELL_MAX, "%s", figure[0]);
    size_t n = json_is_real(cell) && strchr(text, '.') && !strchr(text, '^') ? strlen(text) : 0;
    while (n > 0 && text[n - 1] == '0')
        n--;
    if (n > 0)
        text[n - (text[n - 1] == '.')] = 0;
}

/* Characters, not bytes, of the first n. */
static int width_of(const char *text, size_t n)
{
    int width = 0;
    for (; *text && n > 0; text++, n--)
        width += (*text & 0xC0) != 0x80;
    return width;
}

/* Every column of a table with its width. */
static json_t *columns_of(json_t *table)
{
    json_t *columns = json_object(), *row, *cell;
    const char *name;
    char text[CELL_MAX];
    size_t i;
    json_array_foreach(table, i, row) json_object_foreach(row, name, cell)
    {
        cell_words(name, cell, 1, text);
        const int before = (int)json_integer_value(json_object_get(columns, name));
        const int head = width_of(name, CELL_MAX), own = width_of(text, CELL_MAX), width = MAX_OF(head, own);
        if (!before || width > before)
            json_object_set_new(columns, name, json_integer(width));
    }
    return columns;
}

/* Rows of name and value; empty members and rows, which a table shows, are left out. Seconds of a study that are many
 * stand there in hours and minutes too. */
static void add_lines(json_t *lines, int indent, json_t *o)
{
    const char *key;
    json_t *value, *item;
    size_t i;
    json_object_foreach(o, key, value)
    {
        char text[2 * CELL_MAX] = "", one[CELL_MAX], hours[32];
        size_t used;
        const size_t n = json_array_size(value);
        const double seconds = strncmp(key, "seconds", 7) == 0 ? number_of(value) : 0;
        if (json_is_null(value) || n > LISTED_MAX || json_is_object(json_array_get(value, 0)))
            continue;
        if (!json_is_array(value) && !json_is_object(value))
            cell_words(key, value, 1, text);
        json_array_foreach(value, i, item)
        {
            cell_words(key, item, 1, one);
            used = strlen(text);
            snprintf(text + used, sizeof text - used, "%s%s", i ? " " : "", one);
        }
        if (seconds >= 100) {
            duration_words(seconds, hours);
            used = strlen(text);
            snprintf(text + used, sizeof text - used, " (%s)", hours);
        }
        snprintf(one, sizeof one, "%*s%s", indent, "", key);
        if (text[0] || json_object_size(value) > 0)
            json_put(json_put(figures_row(lines), "=%s", one), " =%s", text);
        add_lines(lines, indent + 2, value);
    }
}

void document_list(Document *d, json_t *o)
{
    add_lines(document_table(d), 0, o);
    json_decref(o);
}

/* ---- text and HTML ----------------------------------------------------------------------------------------------- */

int terminal_width(int fd)
{
    struct winsize w = {0};
    const char *columns = getenv("COLUMNS");
    const int n = columns ? atoi(columns) : 0;
    return n > 0 ? n : ioctl(fd, TIOCGWINSZ, &w) == 0 && w.ws_col > 0 ? w.ws_col : INT_MAX;
}

/* Words, broken at blanks where they reach the width; further lines begin at `indent`. A line's end is a blank, and an
 * empty line stays. */
static void print_words(FILE *out, const char *words, int indent, int width)
{
    int used = 0;
    while (*words) {
        const size_t blanks = strspn(words, " \n"), n = strcspn(words + blanks, " \n");
        const int wide = width_of(words + blanks, n), ends = strncmp(words, "\n\n", 2) == 0;
        const int breaks = ends || (used > indent && used + (int)blanks + wide > width);
        const int before = breaks ? indent : (int)blanks;
        fprintf(out, "%s%*s%.*s", ends ? "\n\n" : breaks ? "\n" : "", before, "", (int)n, words + blanks);
        used = (breaks ? 0 : used) + before + wide;
        words += blanks + n;
    }
    fputc('\n', out);
}

void command_help(const Command *c, FILE *out)
{
    const int width = terminal_width(fileno(out));
    fprintf(out, "example: %s\n\n", c->example);
    print_words(out, c->details, 0, MIN_OF(width, 100));
    fprintf(out, "\nusage: %s %s%s%s [options]\n\n", program_of(c), c->name, c->operand ? " " : "",
            c->operand ? c->operand : "");
    for (const ArgOption *o = c->options; o->name; o++) {
        char left[48], line[400];
        snprintf(left, sizeof left, "%s%s%s", o->name, o->value ? " " : "", o->value ? o->value : "");
        snprintf(line, sizeof line, "  %-25s %s%s%s", left, o->help, o->setting ? "  = --set " : "",
                 o->setting ? o->setting : "");
        print_words(out, line, 28, width);
    }
    fputs("  --help                    this text\n", out);
}

static void print_element(FILE *out, const char *element, const char *words)
{
    fprintf(out, "<%s>", element);
    text_html(out, words);
    fprintf(out, "</%.*s>", (int)strcspn(element, " "), element);
}

/* How pages call what a measure names; anything else by its own name. */
static Words words_of(const char *name)
{
    for (int k = 0; k < MEASURES_LISTED; k++)
        if (strcmp(measure(k)->name, name) == 0)
            return measure(k)->words;
    return (Words){name, "", 1};
}

/* row NULL: the names. Of the columns the first, and those from `from` on before `to`. Words stand left, in the first
 * column and in those whose name begins with a blank. */
static void print_row(FILE *out, json_t *columns, const json_t *row, size_t from, size_t to, int is_html)
{
    const char *name, *head = json_string_value(json_object_iter_value(json_object_iter((json_t *)row)));
    json_t *width;
    size_t i = 0;
    int pending = 0; /* blanks before the next text */
    json_object_foreach(columns, name, width)
    {
        const size_t at = i++;
        const int is_words = *name == ' ', is_head = !row || at == 0;
        const double factor = is_html ? words_of(name).factor * words_of(head ? head : "").factor : 1;
        char text[CELL_MAX], head_text[CELL_MAX];
        if (at > 0 && (at < from || at >= to))
            continue;
        text_copy(text, name);
        if (row)
            cell_words(name, json_object_get(row, name), factor, text);
        const int blanks = (int)json_integer_value(width) - width_of(text, CELL_MAX);
        if (is_html && is_head) {
            const Words w = words_of(text);
            snprintf(head_text, sizeof head_text, *w.unit ? "%s [%s]" : "%s", w.title, w.unit);
            print_element(out, "th", head_text);
        } else if (is_html)
            print_element(out, is_words ? "td class=\"words\"" : "td", text);
        pending += at == 0 ? 0 : is_words ? 2 : 2 + blanks;
        if (!is_html && *text) {
            fprintf(out, "%*s%s", pending, "", text);
            pending = 0;
        }
        pending += at == 0 || is_words ? blanks : 0;
    }
    fputs(is_html ? "</tr>\n<tr>" : "\n", out);
}

/* In bands of as many columns as fit beside the first; words that are too wide for that stand behind it. */
static void print_table(FILE *out, json_t *table, int most, int is_html)
{
    json_t *columns = columns_of(table), *row, *width;
    const size_t n = json_object_size(columns);
    const char *name;
    for (size_t from = 1, to = 0, r; to < n; from = to) {
        size_t i = 0;
        const char *first = "";
        int used = 0, has_names = 0, wide = 0;
        json_object_foreach(columns, name, width)
        {
            used += (i == 0 || i >= from) ? (int)json_integer_value(width) + 2 : 0;
            first = i == from ? name : first;
            wide = i == from ? used - 2 > most : wide;
            to = i <= from || used - 2 <= most ? i + 1 : to;
            has_names |= name[strspn(name, " ")] != 0;
            i++;
        }
        fputs(is_html ? "<table>\n<tr>" : from > 1 ? "\n" : "", out);
        if (wide && *first == ' ') {
            json_array_foreach(table, r, row)
            {
                const char *note = json_string_value(json_object_get(row, first));
                char label[CELL_MAX], text[2 * CELL_MAX];
                cell_words("", json_object_iter_value(json_object_iter(row)), 1, label);
                snprintf(text, sizeof text, "%s: %s", label + strspn(label, " "), note ? note : "");
                if (note && *note)
                    print_words(out, text, 0, most);
            }
            continue;
        }
        if (has_names)
            print_row(out, columns, NULL, from, to, is_html);
        json_array_foreach(table, r, row) print_row(out, columns, row, from, to, is_html);
        fputs(is_html ? "</tr></table>\n" : "", out);
    }
    json_decref(columns);
}

/* As text with a blank line before and behind tables, and where one kind of words follows another. */
void document_print(Document *d, FILE *out, int is_html)
{
    const int width = is_html ? INT_MAX : terminal_width(fileno(out));
    const char *kind, *before = "", *words;
    json_t *part, *content;
    size_t i;
    json_array_foreach(d->parts, i, part) json_object_foreach(part, kind, content)
    {
        const int is_table = strcmp(kind, "table") == 0, is_figure = strcmp(kind, "figure") == 0;
        if (is_figure ? !is_html : is_table && json_array_size(content) == 0)
            continue;
        if (!is_html && *before && (is_table || strcmp(kind, before) != 0))
            fputc('\n', out);
        words = json_string_value(is_figure ? json_array_get(content, 1) : content);
        if (is_figure)
            fprintf(out, "<figure><div data-draw=\"%s\"></div>", json_string_value(json_array_get(content, 0)));
        if (is_table)
            print_table(out, content, width, is_html);
        else if (is_html)
            print_element(out, is_figure ? "figcaption" : strcmp(kind, "note") ? kind : "p class=\"note\"", words);
        else
            print_words(out, words, (int)strspn(words, " "), width);
        fputs(is_figure ? "</figure>\n" : "", out);
        before = kind;
    }
    document_free(d);
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

/* row NULL: the names. */
static void write_row(FILE *out, json_t *columns, const json_t *row)
{
    const char *name, *comma = "";
    char text[CELL_MAX], safe[CELL_MAX];
    json_t *unused;
    json_object_foreach(columns, name, unused)
    {
        const json_t *cell = row ? json_object_get(row, name) : NULL;
        fputs(comma, out);
        comma = ",";
        if (json_is_real(cell)) {
            print_number(out, json_real_value(cell));
        } else if (cell && !json_is_null(cell)) {
            cell_words(name, cell, 1, text);
            cell_text(safe, sizeof safe, text);
            fputs(safe, out);
        } else if (!row) {
            fputs(name, out);
        }
    }
    fputc('\n', out);
}

Status rows_write(json_t *table, const char *path, Err *err)
{
    Output o;
    size_t i;
    json_t *row;
    json_t *columns = columns_of(table);
    Status status = output_open(&o, path, err);
    if (status == STATUS_OK) {
        write_row(o.stream, columns, NULL);
        json_array_foreach(table, i, row) write_row(o.stream, columns, row);
        status = output_close(&o, err);
    }
    json_decref(columns);
    json_decref(table);
    return status;
}

Status show_json(json_t *all, Err *err)
{
    const int failed = json_dumpf(all, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) != 0;
    json_decref(all);
    putchar('\n');
    return failed ? fail(err, STATUS_IO, "standard output: cannot be written") : STATUS_OK;
}

Status document_give(Document *d, const Args *args, Err *err)
{
    const char *csv = args_value(args, "--csv"), *svg = args_value(args, "--svg");
    char path[PATH_MAX];
    Status status = csv && d->rows ? rows_write(json_incref(d->rows), csv, err) : STATUS_OK;
    if (csv && json_array_size(d->summaries) > 0 && strcmp(csv, "-") != 0 &&
        strncmp(csv, "/dev/", 5) != 0) { /* FILE-fractiles.csv */
        snprintf(path, sizeof path, "%.*s-fractiles.csv", (int)strlen(csv) - 4 * text_ends(csv, ".csv"), csv);
        THEN(status, rows_write(json_incref(d->summaries), path, err));
    }
    if (svg)
        THEN(status, drawing_save(d->drawing, json_incref(d->drawn ? d->drawn : d->data), d->width, svg, err));
    if (args_has(args, "--json"))
        THEN(status, show_json(json_incref(d->data), err));
    if (status == STATUS_OK && !outputs_standard(args, 0))
        document_print(d, stdout, 0);
    document_free(d);
    return status;
}
