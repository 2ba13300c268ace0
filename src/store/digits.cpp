// The fewest digits that read back as the same number. C has no function for this: printf takes six times as long, and
// wants to be told how many.
#include <charconv>

extern "C" char *digits_of(char *from, char *to, double value)
{
    return std::to_chars(from, to, value).ptr;
}
