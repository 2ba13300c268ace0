#include "store/notes.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "base/csv.h"
#include "store/folder.h"
#include "store/output.h"

static const char NOTES[] = "notes.json";

Status notes_read(const char *folder, json_t **notes, Err *err)
{
    char path[PATH_MAX], *bytes = NULL;
    const char *key;
    size_t n = 2;
    json_t *text;
    json_error_t error = {0};
    *notes = NULL;
    folder_path(folder, NOTES, path);
    if (folder_has(folder, NOTES))
        TRY(file_read(path, FILE_LARGEST, &bytes, &n, err));
    *notes = json_loadb(bytes ? bytes : "{}", n, JSON_REJECT_DUPLICATES, &error);
    free(bytes);
    int are_notes = json_is_object(*notes);
    json_object_foreach(*notes, key, text) are_notes &= json_is_string(text);
    if (are_notes)
        return STATUS_OK;
    json_decref(*notes);
    *notes = NULL;
    return bad_data(err, "%s:%d: is no object of notes, \"id\": \"text\"%s%s; mend it or move it away", path,
                    error.line > 0 ? error.line : 1, *error.text ? ": " : "", error.text);
}

Status notes_of_run(const Run *run, json_t **notes, Err *err)
{
    const char *key;
    json_t *text;
    void *next;
    *notes = NULL;
    Status status = notes_read(run->folder, notes, err);
    *notes = *notes ? *notes : json_object();
    json_object_foreach_safe(*notes, next, key, text)
    {
        const long id = strtol(key, NULL, 10);
        char number[24];
        snprintf(number, sizeof number, "%ld", id);
        if (strcmp(number, key) != 0 || (id != 0 && run_find(run, id) == run->table.n)) {
            status = bad_data(err, "%s/notes.json: the run has no design '%s': mend the number of its note",
                              run->folder, key);
            json_object_del(*notes, key);
        }
    }
    return status;
}

static Status put(const char *folder, long id, const char *text, Err *err)
{
    char path[PATH_MAX], key[24];
    json_t *notes;
    Output o;
    snprintf(key, sizeof key, "%ld", id);
    if (strlen(text) > NOTE_BYTES_MAX)
        return bad_data(err, "a note has at most %d bytes", NOTE_BYTES_MAX);
    folder_path(folder, NOTES, path);
    TRY(notes_read(folder, &notes, err));
    if (*text)
        json_object_set_new(notes, key, json_string(text));
    else
        json_object_del(notes, key);
    Status status = output_open_inside(&o, path, err);
    if (status == STATUS_OK) {
        const int is_whole = json_dumpf(notes, o.stream, JSON_INDENT(1) | JSON_SORT_KEYS) == 0;
        fputc('\n', o.stream);
        status = output_end(&o, is_whole || ferror(o.stream) ? STATUS_OK : fail_memory(err, 1, "notes"), err);
    }
    json_decref(notes);
    return status;
}

/* The folder is locked meanwhile, for other servers of the run. */
Status notes_put(const char *folder, long id, const char *text, Err *err)
{
    const int lock = open(folder, O_RDONLY | O_CLOEXEC);
    flock(lock, LOCK_EX);
    const Status status = put(folder, id, text, err);
    close(lock);
    return status;
}
