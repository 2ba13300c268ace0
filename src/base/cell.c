#include "base/cell.h"

#include <string.h>

/* Length of the first of those strings (UTF-8) that the text begins with; 0: none. */
static size_t begins_with(const char *text, const char *const list[], size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (strncmp(text, list[i], strlen(list[i])) == 0)
            return strlen(list[i]);
    return 0;
}

/* What a spreadsheet passes over at the beginning: U+00A0, U+FEFF, U+3000, U+2000 to U+200F, U+202F, U+205F. */
static size_t wide_blank(const char *text)
{
    static const char *const BLANKS[] = {"\xc2\xa0", "\xef\xbb\xbf", "\xe3\x80\x80", "\xe2\x80\xaf", "\xe2\x81\x9f"};
    if (strncmp(text, "\xe2\x80", 2) == 0 && (unsigned char)text[2] >= 0x80 && (unsigned char)text[2] <= 0x8f)
        return 3;
    return begins_with(text, BLANKS, sizeof BLANKS / sizeof BLANKS[0]);
}

/* Some read the full-width = + - @ like the narrow ones. */
static int is_formula_sign(const char *text)
{
    static const char *const SIGNS[] = {"=",           "+", "-", "@", "\xef\xbc\x9d", "\xef\xbc\x8b", "\xef\xbc\x8d",
                                        "\xef\xbc\xa0"};
    return begins_with(text, SIGNS, sizeof SIGNS / sizeof SIGNS[0]) > 0;
}

void cell_text(char cell[], size_t size, const char *text)
{
    size_t n = 0;
    int begins = 1;   /* a spreadsheet may take what follows for a cell's beginning */
    size_t blank = 0; /* bytes of a wide one that are still to come */
    for (; *text && n + 1 < size; text++) {
        const char c = *text == ',' ? ';' : *text == '"' || (unsigned char)*text < ' ' ? ' ' : *text;
        blank = blank > 1 ? blank - 1 : begins ? wide_blank(text) : 0;
        if (begins && is_formula_sign(text) && n + 2 < size)
            cell[n++] = '\'';
        cell[n++] = c;
        begins = c == ';' || (begins && (c == ' ' || blank > 0));
    }
    if (((unsigned char)*text & 0xc0) == 0x80) /* the middle of a character: it goes as a whole */
        while (n > 0 && ((unsigned char)cell[--n] & 0xc0) == 0x80)
            ;
    cell[n] = 0;
}
