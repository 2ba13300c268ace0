#include "base/cell.h"

#include <string.h>

void cell_text(char cell[], size_t size, const char *text)
{
    size_t n = 0;
    int begins = 1; /* a spreadsheet may take what follows for a cell's beginning */
    for (; *text && n + 1 < size; text++) {
        const char c = *text == ',' ? ';' : *text == '"' || (unsigned char)*text < ' ' ? ' ' : *text;
        if (begins && strchr("=+-@", c) && n + 2 < size)
            cell[n++] = '\'';
        cell[n++] = c;
        begins = c == ';' || (begins && c == ' ');
    }
    cell[n] = 0;
}
