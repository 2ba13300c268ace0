#include "base/visible.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* Code points that show nothing, by first and last: Unicode 15, categories Cc, Cf, Zs, Zl, Zp and the fillers. */
static const struct {
    uint32_t first, last;
} INVISIBLE[] = {
    {0x80, 0xa0},     {0xad, 0xad},     {0x34f, 0x34f},   {0x61c, 0x61c},      {0x115f, 0x1160},
    {0x1680, 0x1680}, {0x17b4, 0x17b5}, {0x180b, 0x180f}, {0x2000, 0x200f},    {0x2028, 0x202f},
    {0x205f, 0x206f}, {0x3000, 0x3000}, {0x3164, 0x3164}, {0xfe00, 0xfe0f},    {0xfeff, 0xfeff},
    {0xffa0, 0xffa0}, {0xfff0, 0xfffb}, {0xe000, 0xf8ff}, {0xe0000, 0x10ffff},
};

static int is_invisible(uint32_t code)
{
    for (size_t i = 0; i < sizeof INVISIBLE / sizeof INVISIBLE[0]; i++)
        if (code >= INVISIBLE[i].first && code <= INVISIBLE[i].last)
            return 1;
    return 0;
}

/* Bytes of the UTF-8 character that begins here, and its code point; 0: this is none. */
static size_t decode(const char *text, uint32_t *code)
{
    static const struct {
        unsigned char mask, lead;
        uint32_t least;
    } FORM[] = {{0x80, 0x00, 0}, {0xe0, 0xc0, 0x80}, {0xf0, 0xe0, 0x800}, {0xf8, 0xf0, 0x10000}};
    const unsigned char first = text[0];
    for (size_t n = 1; n <= 4; n++) {
        if ((first & FORM[n - 1].mask) != FORM[n - 1].lead)
            continue;
        *code = first & (unsigned char)~FORM[n - 1].mask;
        for (size_t i = 1; i < n; i++) {
            if (((unsigned char)text[i] & 0xc0) != 0x80)
                return 0;
            *code = *code << 6 | (text[i] & 0x3f);
        }
        return *code >= FORM[n - 1].least && *code <= 0x10ffff && (*code < 0xd800 || *code > 0xdfff) ? n : 0;
    }
    return 0;
}

int visible_cut(const char *text, size_t most)
{
    size_t n = strnlen(text, most + 1);
    if (n > most)
        for (n = most; n > 0 && ((unsigned char)text[n] & 0xc0) == 0x80; n--)
            ;
    return (int)n;
}

int visible_text(char out[], size_t size, const char *text)
{
    static const char ESCAPES[] = "\a\b\t\n\v\f\r", LETTERS[] = "abtnvfr";
    char shown[16];
    size_t n = 0;
    while (*text) {
        /* One character as it may be shown, and how many bytes it had. */
        uint32_t code = 0;
        const size_t bytes = decode(text, &code);
        const char *escape = code < 0x80 && bytes ? strchr(ESCAPES, code) : NULL;
        if (escape)
            snprintf(shown, sizeof shown, "\\%c", LETTERS[escape - ESCAPES]);
        else if (bytes == 0 || code < ' ' || code == 0x7f)
            snprintf(shown, sizeof shown, "\\x%02X", (unsigned char)text[0]);
        else if (is_invisible(code))
            snprintf(shown, sizeof shown, "<U+%04X>", code);
        else
            snprintf(shown, sizeof shown, "%.*s", (int)bytes, text);
        text += bytes ? bytes : 1;
        const size_t length = strlen(shown);
        if (n + length >= size) {
            out[n] = 0;
            return 0;
        }
        memcpy(out + n, shown, length);
        n += length;
    }
    out[n] = 0;
    return 1;
}

void cell_text(char cell[], size_t size, const char *text)
{
    size_t n = 0, length;
    int begins = 1; /* a spreadsheet may take what follows for a cell's beginning */
    for (; *text; text += length) {
        uint32_t code;
        length = decode(text, &code);
        if (length == 0)
            code = (unsigned char)*text;
        /* Some spreadsheets read the full-width = + - @ (U+FF1D ...) like the narrow ones. */
        const uint32_t narrow = code > 0xff00 && code < 0xff5f ? code - 0xfee0 : code;
        const size_t apostrophe = begins && length && narrow > 0 && narrow < 0x80 && strchr("=+-@", narrow);
        length += !length;
        if (n + apostrophe + length >= size)
            break;
        if (apostrophe)
            cell[n++] = '\'';
        memcpy(cell + n, text, length);
        if (code == ',' || code == '"' || code < ' ')
            cell[n] = code == ',' ? ';' : ' ';
        begins = cell[n] == ';' || (begins && (cell[n] == ' ' || is_invisible(code)));
        n += length;
    }
    cell[n] = 0;
}
