/* The files of updates: what is taken, where it is kept, and how a door gets it in parts. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <dirent.h>
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "enroll/hub/update/update_keep.h"
#include "tests/enroll/hub/rigs/played_door.h"
#include "tests/enroll/hub/update/bundle_rig.h"
#include "tests/support/scratch.h"

#define BOARD "isotherm-pc-usb-amd64"

static struct iso_fault fault;
static char folder[64], path[96];

static int setup(void **state)
{
    struct store_rig *rig = *state;
    (void)store_rig_setup(state);
    (void)snprintf(folder, sizeof folder, "/tmp/isotherm-updates-XXXXXX");
    assert_non_null(mkdtemp(folder));
    (void)snprintf(rig->store.updates, sizeof rig->store.updates, "%s/updates", folder);
    (void)snprintf(path, sizeof path, "%s/next.raucb", folder);
    return 0;
}

static int teardown(void **state)
{
    char command[96];
    (void)snprintf(command, sizeof command, "rm -rf %s", folder);
    return store_rig_teardown(state) || system(command) ? -1 : 0;
}

static int count(void *context, const struct hub_update_file *file)
{
    (void)file;
    ++*(int *)context;
    return 0;
}

static int files(struct store_rig *rig)
{
    int n = 0;
    store_rig_fine(hub_update_each(&rig->store, count, &n, &fault), &fault);
    return n;
}

/* How many files are in the folder of the hub. */
static int kept_files(void)
{
    char updates[96];
    int n = 0;
    (void)snprintf(updates, sizeof updates, "%s/updates", folder);
    DIR *directory = opendir(updates);
    assert_non_null(directory);
    for (const struct dirent *entry; (entry = readdir(directory));) {
        n += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    }
    assert_int_equal(closedir(directory), 0);
    return n;
}

static void a_file_is_kept_once(void **state)
{
    struct store_rig *rig = *state;
    struct hub_update_file file;
    char kept[HUB_UPDATE_PATH_SIZE], *bytes = NULL, *copied = NULL;
    size_t size = 0, copied_size = 0;
    struct stat s;
    uint8_t digest[32];
    bundle_rig_write(path, bundle_rig_manifest("1.2", BOARD), 200000, 1);
    store_rig_fine(hub_update_keep(&rig->store, path, &file, &fault), &fault);
    assert_string_equal(file.version, "1.2");
    assert_string_equal(file.board, BOARD);
    bytes = scratch_read(path, &size);
    assert_int_equal(file.size, size);
    (void)crypto_hash_sha256(digest, (const uint8_t *)bytes, size);
    assert_memory_equal(file.sha256, digest, sizeof digest);
    hub_update_path(&rig->store, file.sha256, kept);
    assert_int_equal(stat(kept, &s), 0);
    assert_int_equal(s.st_mode & 0777, 0600);
    copied = scratch_read(kept, &copied_size);
    assert_int_equal(copied_size, size);
    assert_memory_equal(copied, bytes, size);
    free(bytes);
    free(copied);
    assert_int_equal(hub_update_keep(&rig->store, path, &file, &fault), -EEXIST);
    assert_non_null(strstr(fault.text, "version 1.2 for the board " BOARD));
    /* Another file of the same version and board is refused, and does not stay. */
    bundle_rig_write(path, bundle_rig_manifest("1.2", BOARD), 200000, 9);
    assert_int_equal(hub_update_keep(&rig->store, path, &file, &fault), -EEXIST);
    assert_int_equal(kept_files(), 1);
    /* The same version for another board is another file. */
    bundle_rig_write(path, bundle_rig_manifest("1.2", "isotherm-rpi4-arm64"), 1000, 2);
    store_rig_fine(hub_update_keep(&rig->store, path, &file, &fault), &fault);
    assert_int_equal(files(rig), 2);
    store_rig_fine(hub_update_remove(&rig->store, "1.2", &fault), &fault);
    assert_int_equal(files(rig), 0);
    assert_int_equal(access(kept, F_OK), -1);
    assert_int_equal(hub_update_remove(&rig->store, "1.2", &fault), -ENOENT);
}

static void refuse(struct store_rig *rig, const char *part)
{
    struct hub_update_file file;
    assert_int_equal(hub_update_keep(&rig->store, path, &file, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "next.raucb: is no update"));
    assert_non_null(strstr(fault.text, part));
    assert_int_equal(files(rig), 0);
}

static void other_files_are_refused(void **state)
{
    struct store_rig *rig = *state;
    struct hub_update_file file;
    struct stat s;
    assert_int_equal(hub_update_keep(&rig->store, path, &file, &fault), -ENOENT);
    scratch_write_text(path, "");
    refuse(rig, "no signed manifest");
    scratch_write_text(path, "some text that is no bundle at all");
    refuse(rig, "no signed manifest");
    bundle_rig_write(path, "no manifest\n", 1000, 1);
    refuse(rig, "cannot be read");
    bundle_rig_write(path, "[update]\ncompatible=" BOARD "\n", 1000, 1);
    refuse(rig, "no version");
    bundle_rig_write(path, bundle_rig_manifest("1.2; rm", BOARD), 1000, 1);
    refuse(rig, "no version");
    bundle_rig_write(path, bundle_rig_manifest("1.2", ""), 1000, 1);
    refuse(rig, "no board");
    bundle_rig_write(path, bundle_rig_manifest("1.2", BOARD), 1000, 1);
    assert_int_equal(stat(path, &s), 0);
    assert_int_equal(truncate(path, s.st_size - 1), 0);
    refuse(rig, "no signed manifest");
}

/* Asks for a part as the door would, and reads it. */
static int fetch(struct store_rig *rig, struct played_door *door, uint64_t after, uint8_t *out,
                 uint64_t *n)
{
    struct iso_fleet_fetch asked = {.door = door->id,
                                    .zone = door->update.rollout,
                                    .after = after,
                                    .what = ISO_FLEET_WANT_UPDATE};
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    uint64_t offset = 0;
    int fd = -1;
    assert_int_equal(iso_fleet_make_fetch(&asked, &door->signs, &bytes), 0);
    assert_true(hub_fetch_is_update(bytes.bytes, bytes.size));
    const int error = hub_answer_update(&rig->store, bytes.bytes, bytes.size, &fd, &offset, n,
                                        &fault);
    iso_fleet_bytes_free(&bytes);
    if (!error) {
        assert_true(*n <= ISO_FLEET_UPDATE_PART_BYTES);
        assert_int_equal(pread(fd, out, *n, (off_t)offset), *n);
        assert_int_equal(close(fd), 0);
    }
    return error;
}

static void a_door_gets_it_in_parts(void **state)
{
    static uint8_t got[3 * ISO_FLEET_UPDATE_PART_BYTES];
    struct store_rig *rig = *state;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    const struct hub_rollout_options options = {.version = "1.2", .zone = "office", .first = 1};
    struct hub_update_file file;
    struct played_door door, other;
    uint64_t n = 0, at = 0;
    uint8_t digest[32];
    bundle_rig_write(path, bundle_rig_manifest("1.2", BOARD), 2 * ISO_FLEET_UPDATE_PART_BYTES, 1);
    store_rig_fine(hub_update_keep(&rig->store, path, &file, &fault), &fault);
    played_door_join(&door, rig, "front", &zone, 1);
    played_door_join(&other, rig, "back", &zone, 1);
    store_rig_fine(hub_rollout_start(&rig->store, &options, &fault), &fault);
    door.health = other.health =
        "{\"update-state\":\"idle\",\"image-version\":\"1.1\",\"image-board\":\"" BOARD "\"}";
    store_rig_fine(played_door_ask(&door, &rig->store, &fault), &fault);
    assert_true(door.is_ordered);
    assert_int_equal(door.update.size, file.size);
    assert_string_equal(door.update.version, "1.2");
    while (at < file.size) {
        store_rig_fine(fetch(rig, &door, at, got + at, &n), &fault);
        assert_true(n > 0);
        at += n;
    }
    assert_int_equal(at, file.size);
    (void)crypto_hash_sha256(digest, got, at);
    assert_memory_equal(digest, door.update.sha256, sizeof digest);
    store_rig_fine(fetch(rig, &door, at + 5, got, &n), &fault);
    assert_int_equal(n, 0);
    /* A door that was not told gets nothing, nor does one after the stop. */
    other.update = door.update;
    assert_int_equal(fetch(rig, &other, 0, got, &n), -EACCES);
    store_rig_fine(hub_rollout_stop(&rig->store, "office", NULL, &fault), &fault);
    assert_int_equal(fetch(rig, &door, 0, got, &n), -EACCES);
    store_rig_fine(hub_rollout_resume(&rig->store, "office", NULL, &fault), &fault);
    /* A file that is not on this machine is asked for again. */
    char kept[HUB_UPDATE_PATH_SIZE];
    hub_update_path(&rig->store, file.sha256, kept);
    assert_int_equal(truncate(kept, 10), 0);
    assert_int_equal(fetch(rig, &door, 0, got, &n), -EAGAIN);
    assert_int_equal(unlink(kept), 0);
    assert_int_equal(fetch(rig, &door, 0, got, &n), -EAGAIN);
    assert_int_equal(hub_update_remove(&rig->store, "1.2", &fault), -EALREADY);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_file_is_kept_once, setup, teardown),
        cmocka_unit_test_setup_teardown(other_files_are_refused, setup, teardown),
        cmocka_unit_test_setup_teardown(a_door_gets_it_in_parts, setup, teardown),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}
