/* store/csv_files.h -- evaluations.csv and front.csv beside the database, in step with its finished generations.
 *
 * evaluations.csv grows by the rows that are committed. front.csv, the front of the search joined by the polished designs
 * of earlier sessions, is replaced as a whole, in a large run (FRONT_ALWAYS evaluations) seldom enough that it takes a
 * twentieth of the time at most, and at the end (is_behind). Without replicates a design keeps its line: those of the file
 * before are copied, if it is still the one that was written or looked at.
 *
 * Life cycle  {0} -> csv_files_begin or csv_files_resume -> csv_files_append, ... -> csv_files_close, or csv_files_free
 * Memory      a batch of rows; with deviations or limits on further results those of all designs
 * Threads     one at a time */
#ifndef IMTET_STORE_CSV_FILES_H
#define IMTET_STORE_CSV_FILES_H

#include <sys/stat.h>

#include "moga/search.h"
#include "store/database.h"
#include "store/folder.h"
#include "store/rows.h"
#include "store/run.h"

typedef struct {
    const Folder *folder; /* borrowed, like schema and run */
    const Schema *schema;
    const Run *run; /* as it was when the session began; NULL: a new one */
    Append evaluations;
    size_t n_appended; /* designs of the search that evaluations.csv has */
    double *kept;      /* (n_appended, n_kept) what front.csv has of each as stored: deviations, limited results */
    size_t n_kept;
    double next_front; /* [s] of the clock, before which front.csv is not replaced again */
    int is_behind;     /* front.csv is of an earlier generation */
    struct stat front; /* of front.csv, whose lines are known; st_ino 0: they are not */
} CsvFiles;

enum { FRONT_ALWAYS = 4000 };

Status csv_files_begin(CsvFiles *c, const Folder *folder, const Schema *schema, Err *err);

/* Both are exports, whatever was done to them meanwhile: regenerated if all of the run is there. If its finished evaluations
 * are not (n_ahead), they pass by, before anything else, are compared with both files line by line, and what differs is
 * regenerated. */
Status csv_files_resume(CsvFiles *c, const Folder *folder, const Schema *schema, const Run *run, Err *err);

typedef struct {
    RowLines lines, front; /* of evaluations.csv and of front.csv */
} CsvPassing;

void csv_files_pass(const CsvFiles *c, CsvPassing *p);
void csv_files_pass_design(const CsvFiles *c, CsvPassing *p, long id); /* of a finished generation */
/* passed: whether all of them did; else nothing is changed. */
Status csv_files_passed(CsvFiles *c, CsvPassing *p, Database *db, Status passed, Err *err);

/* Up to evaluation n, as the database has them now. */
Status csv_files_append(CsvFiles *c, Database *db, size_t n, Err *err);

/* front.csv as of this generation, whose evaluations are appended, where it is due. */
Status csv_files_front(CsvFiles *c, const SearchView *view, Err *err);

/* Both files, of the run. */
Status csv_files_replace(const Folder *folder, const Run *run, Err *err);

Status csv_files_close(CsvFiles *c, Err *err);
void csv_files_free(CsvFiles *c);

#endif
