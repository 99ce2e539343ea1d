/* FETCH of a door: a part of the file of an update. */
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/file.h"
#include "enroll/hub/answer/hub_answer.h"
#include "enroll/hub/answer/hub_sender.h"
#include "enroll/hub/update/hub_update.h"

bool hub_fetch_is_update(const void *bytes, size_t size)
{
    const uint8_t *p = bytes;
    enum iso_fleet_kind kind;
    /* What is fetched is the last field in front of the signature. */
    return iso_fleet_kind_of(bytes, size, &kind) == 0 && kind == ISO_FLEET_FETCH &&
           p[size - ISO_FLEET_SIGNATURE_BYTES - 1] == ISO_FLEET_WANT_UPDATE;
}

/* The digest and the size of the file that the door was told to fetch. */
static int find_file(struct hub_store *store, const struct hub_door *door,
                     const struct iso_fleet_fetch *fetch, uint8_t sha256[32], uint64_t *size,
                     struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &fetch->zone);
    hub_value_id(&values, &door->id);
    int error = hub_db_run_often(
        store->db,
        "SELECT f.sha256, f.size FROM rollout r JOIN rollout_door d ON d.rollout = r.id "
        "JOIN update_file f ON f.version = r.version AND f.board = d.board "
        "WHERE r.id = $1 AND d.door = $2 AND r.state = 'running' AND d.state IN ('told', "
        "'fetching', 'installed')",
        &values, &rows, fault);
    if (error) {
        return error;
    }
    if (PQntuples(rows) == 0 || hub_row_copy(rows, 0, 0, sha256, 32)) {
        error = iso_fault_set(fault, -EACCES, "door %s: was not told to fetch this update",
                              door->name);
    } else {
        *size = (uint64_t)hub_row_integer(rows, 0, 1);
    }
    PQclear(rows);
    return error;
}

static int open_file(struct hub_store *store, const uint8_t sha256[32], uint64_t size, int *fd,
                     struct iso_fault *fault)
{
    char path[HUB_UPDATE_PATH_SIZE];
    struct stat s;
    hub_update_path(store, sha256, path);
    int file = -1;
    const int error = iso_file_open(path, O_RDONLY, ISO_FLEET_UPDATE_BYTES_MAX, &file, fault);
    if (error || fstat(file, &s) || (uint64_t)s.st_size != size) {
        if (!error) {
            (void)close(file);
        }
        return iso_fault_set(fault, -EAGAIN, "%s: the file of an update is not here, or damaged",
                             path);
    }
    *fd = file;
    return 0;
}

int hub_answer_update(struct hub_store *store, const void *bytes, size_t size, int *fd,
                      uint64_t *offset, uint64_t *length, struct iso_fault *fault)
{
    struct hub_door door;
    struct iso_fleet_fetch fetch;
    uint8_t sha256[32];
    uint64_t file_size = 0;
    int error = hub__sender(store, bytes, size, &door, fault);
    if (error) {
        return error;
    }
    error = iso_fleet_read_fetch(bytes, size, door.signs, &fetch);
    if (error || fetch.what != ISO_FLEET_WANT_UPDATE) {
        return hub__sender_fault(&door, "fetch", error ? error : -EBADMSG, fault);
    }
    error = find_file(store, &door, &fetch, sha256, &file_size, fault);
    error = error ? error : open_file(store, sha256, file_size, fd, fault);
    if (!error) {
        const uint64_t left = fetch.after < file_size ? file_size - fetch.after : 0;
        *offset = fetch.after < file_size ? fetch.after : file_size;
        *length = left < ISO_FLEET_UPDATE_PART_BYTES ? left : ISO_FLEET_UPDATE_PART_BYTES;
        /* The event loop sends it, and shall not wait for the disk. */
        (void)posix_fadvise(*fd, (off_t)*offset, (off_t)*length, POSIX_FADV_WILLNEED);
    }
    return error;
}
