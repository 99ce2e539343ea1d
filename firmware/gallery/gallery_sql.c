/* Calls of SQLite, with its failures described in words. */
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/disk_wait.h"
#include "drivers/file/file.h"
#include "drivers/file/storage_fault.h"
#include "firmware/gallery/gallery_db_state.h"

enum { BUSY_MS = 1000 }; /* how long to wait for another process, which may make a copy */

/* More than 400,000 people need. A longer file is not a gallery. */
static const uint64_t bytes_max = (uint64_t)1 << 32;

/* The journal is deleted when a change is complete; EXTRA then synchronises the directory, too.
 * Exclusive locking prevents other writers from changing data that is also kept in memory. Deleted
 * data is overwritten. */
static const char settings[] = "PRAGMA locking_mode = EXCLUSIVE;"
                               "PRAGMA journal_mode = DELETE;"
                               "PRAGMA synchronous = EXTRA;"
                               "PRAGMA temp_store = MEMORY;"
                               "PRAGMA foreign_keys = ON;"
                               "PRAGMA secure_delete = ON;"
                               "PRAGMA trusted_schema = OFF;"
                               "PRAGMA cell_size_check = ON;";

int iso_gallery_db_damaged(const struct iso_gallery_db *db, const char *what,
                           struct iso_fault *fault)
{
    return iso_fault_set_code(
        fault, ISO_FAULT_GALLERY_DAMAGED, -EBADMSG,
        "%s: damaged (%s); put a copy in its place, or move it and its anchor "
        "away (see --accept-state)",
        db->path, what);
}

/* Returns the errno behind an error of SQLite, as far as SQLite knows it: from the database, from
 * its journal, or from the last call. */
static int system_error(const struct iso_gallery_db *db)
{
    sqlite3_file *journal = NULL;
    int error = 0;
    if (sqlite3_errcode(db->sqlite) == SQLITE_FULL) {
        return -ENOSPC;
    }
    (void)sqlite3_file_control(db->sqlite, "main", SQLITE_FCNTL_LAST_ERRNO, &error);
    (void)sqlite3_file_control(db->sqlite, "main", SQLITE_FCNTL_JOURNAL_POINTER, &journal);
    if (error == 0 && journal && journal->pMethods) {
        (void)journal->pMethods->xFileControl(journal, SQLITE_FCNTL_LAST_ERRNO, &error);
    }
    if (!error) {
        error = sqlite3_system_errno(db->sqlite);
    }
    return error > 0 ? -error : -EIO;
}

int iso__gallery_fail(const struct iso_gallery_db *db, struct iso_fault *fault)
{
    const char *said = sqlite3_errmsg(db->sqlite);
    switch (sqlite3_errcode(db->sqlite)) {
    case SQLITE_CORRUPT:
        return iso_gallery_db_damaged(db, said, fault);
    case SQLITE_NOTADB:
        return iso_fault_set_code(fault, ISO_FAULT_GALLERY_DAMAGED, -EMEDIUMTYPE,
                                  "%s: no gallery, or its beginning is damaged", db->path);
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
        return iso_fault_set_code(fault, ISO_FAULT_STORE_BUSY, -EBUSY,
                                  "%s: another process uses it", db->path);
    case SQLITE_READONLY:
        return iso_fault_set_code(fault, ISO_FAULT_DISK_READ_ONLY, -EROFS, "%s: cannot be written",
                                  db->path);
    case SQLITE_NOMEM:
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", db->path);
    case SQLITE_FULL:
    case SQLITE_IOERR:
    case SQLITE_CANTOPEN:
        return iso_storage_refused(db->path, system_error(db), fault);
    default:
        return iso_fault_set_code(fault, ISO_FAULT_GALLERY_DAMAGED, -EIO, "%s: %s", db->path, said);
    }
}

int iso__gallery_execute(const struct iso_gallery_db *db, const char *sql, struct iso_fault *fault)
{
    iso_disk_wait_begin();
    const int result = sqlite3_exec(db->sqlite, sql, NULL, NULL, NULL);
    iso_disk_wait_end();
    return result == SQLITE_OK ? 0 : iso__gallery_fail(db, fault);
}

int iso__gallery_prepare(const struct iso_gallery_db *db, const char *sql, sqlite3_stmt **out,
                         struct iso_fault *fault)
{
    return sqlite3_prepare_v2(db->sqlite, sql, -1, out, NULL) == SQLITE_OK
               ? 0
               : iso__gallery_fail(db, fault);
}

int iso__gallery_finish(const struct iso_gallery_db *db, sqlite3_stmt *statement,
                        struct iso_fault *fault)
{
    iso_disk_wait_begin();
    const int step = sqlite3_step(statement);
    iso_disk_wait_end();
    const int error = step == SQLITE_DONE ? 0 : iso__gallery_fail(db, fault);
    (void)sqlite3_finalize(statement);
    return error;
}

int iso__gallery_ask(const struct iso_gallery_db *db, const char *sql, char *answer, size_t size,
                     struct iso_fault *fault)
{
    sqlite3_stmt *query = NULL;
    int error = 0;
    iso_disk_wait_begin(); /* the first query may roll back a journal */
    int step = sqlite3_prepare_v2(db->sqlite, sql, -1, &query, NULL);
    step = step == SQLITE_OK ? sqlite3_step(query) : step;
    iso_disk_wait_end();
    if (step == SQLITE_ROW) {
        const unsigned char *text = sqlite3_column_text(query, 0);
        (void)snprintf(answer, size, "%s", text ? (const char *)text : "");
    } else if (step == SQLITE_DONE) {
        *answer = '\0';
    } else {
        error = iso__gallery_fail(db, fault);
    }
    (void)sqlite3_finalize(query);
    return error;
}

/* Refuses files that are not regular. SQLite opens the database and its journal itself, and would
 * wait for a FIFO in their place. */
static int check_files(const char *path, struct iso_fault *fault)
{
    static const char *const suffixes[] = {"", "-journal", "-wal"};
    for (size_t i = 0; i < sizeof suffixes / sizeof *suffixes; i++) {
        char file[PATH_MAX];
        struct iso_fault why = {.text = ""};
        if (snprintf(file, sizeof file, "%s%s", path, suffixes[i]) >= PATH_MAX) {
            return iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", path);
        }
        const int error = iso_file_check(file, bytes_max, &why);
        if (error && (error != -ENOENT || i == 0)) {
            return iso_fault_set_code(fault, why.code,
                                      error == -EISDIR || error == -ELOOP ? -EMEDIUMTYPE : error,
                                      "%s", why.text);
        }
    }
    return 0;
}

/* Resolves symbolic links among the path's directories, because SQLITE_OPEN_NOFOLLOW refuses those,
 * too. */
static int resolve_directory(const char *path, char out[PATH_MAX], struct iso_fault *fault)
{
    char directory[PATH_MAX], resolved[PATH_MAX];
    const char *slash = strrchr(path, '/');
    const char *base = slash ? slash + 1 : path;
    (void)snprintf(directory, sizeof directory, "%.*s", slash ? (int)(base - path) : 1,
                   slash ? path : ".");
    if (!realpath(directory, resolved)) {
        return iso_file_fault(directory, -errno, fault);
    }
    return snprintf(out, PATH_MAX, "%s/%s", resolved, base) < PATH_MAX
               ? 0
               : iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", path);
}

int iso__gallery_connect(struct iso_gallery_db *db, const char *path, struct iso_fault *fault)
{
    char resolved[PATH_MAX];
    int error = check_files(path, fault);
    if (!error) {
        error = resolve_directory(path, resolved, fault);
    }
    if (error) {
        return error;
    }
    const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOFOLLOW;
    if (sqlite3_open_v2(resolved, &db->sqlite, flags, NULL) != SQLITE_OK) {
        return db->sqlite ? iso__gallery_fail(db, fault)
                          : iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    (void)sqlite3_busy_timeout(db->sqlite, BUSY_MS);
    return iso__gallery_execute(db, settings, fault);
}

void iso__gallery_disconnect(struct iso_gallery_db *db)
{
    (void)sqlite3_close(db->sqlite);
    db->sqlite = NULL;
}
