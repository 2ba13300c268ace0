/* What of motion.text might read a text that is not understood. */
#include "motion/formats/record.h"

/* How many numbers the line has; 0: something else stands in it. */
static int count_numbers(Lines l)
{
    int n = 0;
    double x;
    for (const char *p = l.from; p < l.to; n++)
        if (cell_number(cell_next(&p, l.to, " ,;"), 0, &x) != NUMBER)
            return 0;
    return n;
}

void text_form_suggest(const Lines *start, char form[TEXT_FORM_MAX])
{
    Lines l = *start, two = l;
    int width = 0;

    /* The first two lines of equally many numbers. */
    while (lines_next_filled(&l) && !((width = count_numbers(l)) && two.from && count_numbers(two) == width))
        two = l;
    form[0] = 0;
    if (l.from && two.from && width > 0)
        snprintf(form, TEXT_FORM_MAX,
                 width == 1   ? "skip=%d"
                 : width == 2 ? "skip=%d,columns=time:1,value:2"
                              : "skip=%d,per_line=%d (or columns=time:1,value:2)",
                 two.number - 1, width);
}
