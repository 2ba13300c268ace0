#include "scene/compiled_in.h"

#include <string.h>

#define FILES(X)                                                                                                       \
    X("guyan", "K.csv", guyan_K)                                                                                       \
    X("guyan", "M.csv", guyan_M)                                                                                       \
    X("guyan", "nodes.csv", frame_nodes)                                                                               \
    X("guyan", "sections.csv", frame_sections)                                                                         \
    X("guyan", "elements.csv", frame_elements)                                                                         \
    X("appendix", "K.csv", appendix_K)                                                                                 \
    X("appendix", "M.csv", appendix_M)

#define X(model, file, name)                                                                                           \
    extern const char _binary_configs_sac20_##name##_csv_start[], _binary_configs_sac20_##name##_csv_end[];
FILES(X)
#undef X

static const struct {
    const char *model, *file, *start, *end;
} FILE_LIST[] = {
#define X(model, file, name)                                                                                           \
    {model, file, _binary_configs_sac20_##name##_csv_start, _binary_configs_sac20_##name##_csv_end},
    FILES(X)
#undef X
};

int is_compiled_in(const char *model)
{
    return compiled_in(model, "K.csv").text != NULL;
}

CompiledIn compiled_in(const char *model, const char *file)
{
    for (size_t i = 0; i < sizeof FILE_LIST / sizeof FILE_LIST[0]; i++)
        if (!strcmp(model, FILE_LIST[i].model) && !strcmp(file, FILE_LIST[i].file))
            return (CompiledIn){FILE_LIST[i].start, (size_t)(FILE_LIST[i].end - FILE_LIST[i].start)};
    return (CompiledIn){0};
}
