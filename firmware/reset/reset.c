#include "firmware/reset/reset.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "drivers/file/data_file.h"
#include "drivers/file/directory.h"
#include "drivers/file/file.h"
#include "drivers/file/storage_fault.h"

bool iso_reset_is_pending(const char *marker)
{
    return access(marker, F_OK) == 0 || errno != ENOENT;
}

int iso_reset_begin(const struct iso_reset_places *places, struct iso_fault *fault)
{
    static const char text[] = "A factory reset was begun. isothermd --finish-reset ends it.\n";
    return iso_data_file_replace(places->marker, text, sizeof text - 1, fault);
}

/* ---- one file ---- */

/* Makes the names beside `path` permanent. A folder that does not exist has none. */
static int sync_names(const char *path, struct iso_fault *fault)
{
    const int error = iso_directory_sync(path, fault);
    return error == -ENOENT ? 0 : error;
}

static int remove_file(const char *path, struct iso_fault *fault)
{
    return unlink(path) && errno != ENOENT ? iso_storage_refused(path, -errno, fault) : 0;
}

/* Overwrites the contents on the disk before the name is gone. A file that cannot be opened is
 * deleted all the same: it may be a link. */
static int wipe_file(const char *path, struct iso_fault *fault)
{
    int fd = -1;
    if (iso_file_open(path, O_RDWR, ISO_FILE_ANY_SIZE, &fd, NULL) == 0) {
        iso_data_file_overwrite(fd);
        (void)fsync(fd);
        (void)close(fd);
    }
    return remove_file(path, fault);
}

/* A key, and its successor, which remains if a change was cut short. */
static int wipe_key(const char *path, struct iso_fault *fault)
{
    char next[ISO_RESET_PATH_SIZE + 8];
    if (!*path) {
        return 0;
    }
    (void)snprintf(next, sizeof next, "%s.new", path);
    int error = wipe_file(path, fault);
    if (!error) {
        error = wipe_file(next, fault);
    }
    return error ? error : sync_names(path, fault);
}

/* ---- all files of a store ---- */

/* Splits a path. Returns the last part; `folder` gets the rest. */
static const char *split(const char *path, char folder[ISO_RESET_PATH_SIZE])
{
    const char *slash = strrchr(path, '/');
    if (!slash) {
        (void)snprintf(folder, ISO_RESET_PATH_SIZE, ".");
        return path;
    }
    (void)snprintf(folder, ISO_RESET_PATH_SIZE, "%.*s", slash == path ? 1 : (int)(slash - path),
                   path);
    return slash + 1;
}

static bool belongs(const char *file, const char *store)
{
    const size_t length = strlen(store);
    return strncmp(file, store, length) == 0 &&
           (file[length] == '\0' || file[length] == '.' || file[length] == '-');
}

/* Removes every file of the open folder that belongs to the store. */
static int remove_named(DIR *open, const char *folder, const char *store, struct iso_fault *fault)
{
    char path[ISO_RESET_PATH_SIZE + sizeof((struct dirent *)0)->d_name];
    int error = 0;
    for (const struct dirent *entry; !error && (entry = readdir(open));) {
        if (belongs(entry->d_name, store)) {
            (void)snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
            error = remove_file(path, fault);
        }
    }
    return error;
}

/* Removes all files of a store, and makes that permanent. */
static int remove_store(const char *path, struct iso_fault *fault)
{
    char folder[ISO_RESET_PATH_SIZE];
    if (!*path) {
        return 0;
    }
    const char *name = split(path, folder);
    DIR *open = opendir(folder);
    if (!open) {
        return errno == ENOENT ? 0 : iso_file_fault(folder, -errno, fault);
    }
    const int error = remove_named(open, folder, name, fault);
    (void)closedir(open);
    return error ? error : iso_directory_sync(path, fault);
}

/* ---- a folder ---- */

static int remove_entry(const char *path, const struct stat *status, int kind, struct FTW *at)
{
    (void)status;
    (void)kind;
    return at->level > 0 && remove(path) ? -errno : 0;
}

/* Deletes what a folder has, and leaves the folder, which has an owner. */
static int empty_folder(const char *folder, struct iso_fault *fault)
{
    enum { DESCRIPTORS = 16 };
    char inside[ISO_RESET_PATH_SIZE + 2];
    if (!*folder) {
        return 0;
    }
    if (access(folder, F_OK)) {
        return errno == ENOENT ? 0 : iso_file_fault(folder, -errno, fault);
    }
    const int r = nftw(folder, remove_entry, DESCRIPTORS, FTW_DEPTH | FTW_PHYS | FTW_MOUNT);
    if (r) {
        return iso_storage_refused(folder, r == -1 ? -errno : r, fault);
    }
    (void)snprintf(inside, sizeof inside, "%s/.", folder);
    return iso_directory_sync(inside, fault);
}

/* ---- in order ---- */

int iso_reset_finish(const struct iso_reset_places *places, struct iso_fault *fault)
{
    int error = 0;
    for (size_t i = 0; !error && i < ISO_RESET_KEYS; i++) {
        error = wipe_key(places->keys[i], fault);
    }
    for (size_t i = 0; !error && i < ISO_RESET_STORES; i++) {
        error = remove_store(places->stores[i], fault);
    }
    for (size_t i = 0; !error && i < ISO_RESET_FOLDERS; i++) {
        error = empty_folder(places->folders[i], fault);
    }
    if (!error && *places->done) {
        error = rename(places->marker, places->done)
                    ? iso_storage_refused(places->marker, -errno, fault)
                    : 0;
    } else if (!error) {
        error = remove_file(places->marker, fault);
    }
    return error ? error : iso_directory_sync(places->marker, fault);
}
