/* Finds out what the disk holds after a change whose outcome is not known.
 *
 * An error of COMMIT does not tell whether the transaction is on the disk: SQLite may report that
 * the last synchronisation failed although the transaction is on the disk, and its cache may then
 * differ from the file. Therefore the connection is given up. A new connection plays back a journal
 * that is still valid, and reads the head, which is either the one before the change or the one
 * after it. The journal is then deleted and the directory synchronised, so that a power failure
 * cannot bring the other state back.
 *
 * Until this succeeds the database is out of service: nothing is read from it, and nothing is
 * written to it. */
#include <errno.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "drivers/file/directory.h"
#include "drivers/file/storage_fault.h"
#include "firmware/gallery/gallery_db_state.h"

/* Removes the journal, which is not needed any more: no process has it open between two changes. */
static int delete_journal(const struct iso_gallery_db *db, struct iso_fault *fault)
{
    char journal[PATH_MAX];
    if (snprintf(journal, sizeof journal, "%s-journal", db->path) >= PATH_MAX) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", db->path);
    }
    if (unlink(journal) && errno != ENOENT) {
        return iso_storage_refused(journal, -errno, fault);
    }
    return iso_directory_sync(db->path, fault);
}

/* Connects again and reads the head. db->head, db->draft and db->seal are then those on the
 * disk. */
static int read_again(struct iso_gallery_db *db, struct iso_fault *fault)
{
    iso__gallery_disconnect(db);
    int error = iso__gallery_connect(db, db->path, fault);
    if (!error) {
        error = iso__gallery_execute(db, "BEGIN EXCLUSIVE", fault);
    }
    if (!error) {
        error = iso__gallery_read_head(db, fault);
    }
    if (!error) {
        error = iso__gallery_find_access(db, fault);
    }
    if (!error) {
        error = iso__gallery_find_vectors(db, fault);
    }
    if (!error) {
        error = iso__gallery_execute(db, "COMMIT", fault);
    }
    return error ? error : delete_journal(db, fault);
}

static int give_up(struct iso_gallery_db *db, const struct iso_fault *why, struct iso_fault *fault)
{
    iso__gallery_disconnect(db);
    db->lost = true;
    (void)iso_fault_set_code(&db->lost_fault, why->code, -EIO, "%.*s", (int)(sizeof why->text - 64),
                             why->text);
    return iso__gallery_in_service(db, fault);
}

int iso__gallery_in_service(const struct iso_gallery_db *db, struct iso_fault *fault)
{
    return db->lost ? iso_fault_set_code(fault, db->lost_fault.code, -EIO,
                                         "the gallery is out of service: %s", db->lost_fault.text)
                    : 0;
}

static bool is_same(const struct iso_gallery_head *a, const struct iso_gallery_head *b)
{
    return a->changes == b->changes && a->next == b->next &&
           sodium_memcmp(a->digest, b->digest, sizeof a->digest) == 0;
}

int iso__gallery_settle(struct iso_gallery_db *db, int error, struct iso_fault *fault)
{
    const struct iso_gallery_head before = db->head, after = db->draft;
    struct iso_fault why = {.text = ""};
    if (read_again(db, &why)) {
        return give_up(db, &why, fault);
    }
    if (is_same(&db->head, &after)) {
        return 0;
    }
    if (!is_same(&db->head, &before)) {
        (void)iso_gallery_db_damaged(db, "the head is neither the old nor the new one", &why);
        return give_up(db, &why, fault);
    }
    if (iso_storage_is_refusal(error)) {
        iso_storage_add(fault, "nothing was changed");
    }
    return error;
}

int iso_gallery_db_state(const struct iso_gallery_db *db, struct iso_fault *fault)
{
    return iso__gallery_in_service(db, fault);
}

int iso_gallery_db_recover(struct iso_gallery_db *db, struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    int error = read_again(db, &why);
    if (!error) {
        error = iso__gallery_check_anchor(db, &why);
    }
    if (error) {
        return give_up(db, &why, fault);
    }
    db->lost = false;
    return 0;
}

int iso_gallery_db_give_up(struct iso_gallery_db *db, const struct iso_fault *why,
                           struct iso_fault *fault)
{
    return give_up(db, why, fault);
}
