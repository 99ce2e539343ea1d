/* The gallery when its file is damaged, is no gallery, or is changed while the gallery is open. */
#include <errno.h>
#include <fcntl.h>
#include <linux/capability.h>
#include <signal.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/gallery/gallery.h"
#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/support/child_end.h"
#include "tests/support/scratch.h"

enum { CAPACITY = 1000 };

/* Asserts that the file is refused with this error and text, and that it stays unchanged. */
static void expect_refusal(const char *directory, int error, const char *text)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    size_t size_before = 0, size_after = 0;
    void *before = scratch_read(scratch_path(directory, "g.db"), &size_before);
    assert_int_equal(gallery_rig_try_open(directory, &gallery, &fault), error);
    if (!strstr(fault.text, text) || !strstr(fault.text, "/g.db: ")) {
        fail_msg("'%s' does not say '%s'", fault.text, text);
    }
    assert_null(gallery);
    void *after = scratch_read(scratch_path(directory, "g.db"), &size_after);
    assert_int_equal(size_after, size_before);
    assert_memory_equal(after, before, size_before);
    free(before);
    free(after);
}

/* ---- files that are no gallery ---- */

static void an_empty_file_is_a_lost_gallery(void **state)
{
    scratch_write_text(scratch_path(*state, "g.db"), "");
    expect_refusal(*state, -EBADMSG, "damaged (the file is empty); put a copy in its place");
}

static void text_is_no_gallery(void **state)
{
    char text[2000];
    memset(text, 'x', sizeof text);
    scratch_write(scratch_path(*state, "g.db"), text, sizeof text);
    expect_refusal(*state, -EMEDIUMTYPE, "no gallery, or its beginning is damaged");
}

static void a_directory_is_no_gallery(void **state)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    scratch_mkdir(scratch_path(*state, "g.db"));
    assert_int_equal(gallery_rig_try_open(*state, &gallery, &fault), -EMEDIUMTYPE);
    assert_non_null(strstr(fault.text, "not a file"));
}

static void a_database_of_others_is_no_gallery(void **state)
{
    gallery_rig_execute(*state, "CREATE TABLE person (id INTEGER); PRAGMA user_version = 1;");
    expect_refusal(*state, -EMEDIUMTYPE, "a database of another application");
}

static void a_newer_gallery_is_left_alone(void **state)
{
    gallery_rig_make(*state, 2);
    gallery_rig_execute(*state, "PRAGMA user_version = 5");
    expect_refusal(*state, -EPROTONOSUPPORT, "of version 5, this program knows version 4");
}

static void needs_its_directory(void **state)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    struct iso_gallery_options options = stores_gallery(*state);
    options.path = "/nonexistent/g.db";
    assert_int_equal(iso_gallery_open(&options, &gallery, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "/nonexistent/g.db.new: No such file or directory"));
}

/* ---- damage ---- */

static void a_file_that_is_cut_short_anywhere_is_refused(void **state)
{
    size_t size = 0;
    gallery_rig_make(*state, 12);
    char *whole = scratch_read(scratch_path(*state, "g.db"), &size);
    for (size_t length = 100; length < size; length += 1500) {
        struct iso_gallery *gallery = NULL;
        struct iso_fault fault = {.text = ""};
        scratch_write(scratch_path(*state, "g.db"), whole, length);
        const int error = gallery_rig_try_open(*state, &gallery, &fault);
        if (error != -EBADMSG && error != -EMEDIUMTYPE) {
            fail_msg("cut at %zu of %zu: %d %s", length, size, error, fault.text);
        }
    }
    scratch_write(scratch_path(*state, "g.db"), whole, size);
    iso_gallery_close(gallery_rig_open(*state));
    free(whole);
}

/* The seal protects every byte of every template, and the integrity check or the schema protects
 * every page. A change is either found, or it was in free space. It never causes a crash or another
 * template. */
static void a_changed_file_never_yields_another_template(void **state)
{
    size_t size = 0;
    int refused = 0;
    gallery_rig_make(*state, 4);
    char *whole = scratch_read(scratch_path(*state, "g.db"), &size);
    for (size_t at = 0; at < size; at += 61) {
        struct iso_gallery *gallery = NULL;
        whole[at] ^= 0x20;
        scratch_write(scratch_path(*state, "g.db"), whole, size);
        whole[at] ^= 0x20;
        if (gallery_rig_try_open(*state, &gallery, NULL)) {
            refused++;
            continue;
        }
        const struct iso_candidate_list all = iso_gallery_everybody(gallery);
        for (int i = 0; i < all.n_entries; i++) {
            const int face = puppet_face_of(all.entries[i].tmpl);
            const struct iso_template wanted = puppet_template(face, PUPPET_ALGORITHM);
            assert_memory_equal(all.entries[i].tmpl, &wanted, sizeof wanted);
        }
        iso_gallery_close(gallery);
    }
    assert_true(refused > 20);
    free(whole);
}

static void a_damaged_template_is_refused(void **state)
{
    gallery_rig_make(*state, 2);
    gallery_rig_execute(*state,
                        "UPDATE template SET record = zeroblob(length(record)) WHERE id = 4");
    expect_refusal(*state, -EBADMSG, "damaged (the record of template 4 is not what was stored)");
}

static void a_template_without_a_person_is_refused(void **state)
{
    gallery_rig_make(*state, 2);
    gallery_rig_execute(*state, "PRAGMA foreign_keys = OFF; DELETE FROM person WHERE id = 3");
    expect_refusal(*state, -EBADMSG, "damaged (a template belongs to nobody)");
}

/* ---- other processes ---- */

static void one_process_has_it(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state), *second = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(gallery_rig_try_open(*state, &second, &fault), -EBUSY);
    assert_non_null(strstr(fault.text, "another process uses it"));
    iso_gallery_close(gallery);
}

/* ---- a record that changes while the gallery is open ---- */

/* So many people that SQLite does not keep the whole file in memory, and reads the first record
 * again. */
enum { MORE_THAN_KEPT = 900, PART = 64 };

static void add_whole_faces(const char *directory)
{
    enum { BATCH = 100 };
    static struct iso_gallery_item items[BATCH];
    static uint8_t bytes[BATCH][ISO_TEMPLATE_BYTES_MAX];
    struct iso_gallery *gallery = gallery_rig_open(directory);
    for (int i = 0; i < MORE_THAN_KEPT; i++) {
        struct iso_gallery_item *item = &items[i % BATCH];
        struct iso_template tmpl = puppet_template(i, PUPPET_ALGORITHM);
        size_t added = 0;
        for (int k = 0; k < ISO_UPPER_ROWS * ISO_UPPER_COLUMNS; k++) {
            const int row = k / ISO_UPPER_COLUMNS, column = k % ISO_UPPER_COLUMNS;
            tmpl.upper.z_mm[row][column] = (float)(k % 50 - i % 7);
            tmpl.upper.kind[row][column] = ISO_UPPER_MEASURED;
        }
        const int size = iso_template_serialise(&tmpl, bytes[i % BATCH], sizeof *bytes);
        assert_true(size > 0);
        *item = (struct iso_gallery_item){.person = {.enrolled_s = 1}, .n = 1};
        (void)snprintf(item->person.name, sizeof item->person.name, "person %d", i);
        item->templates[0].algorithm = PUPPET_ALGORITHM;
        item->templates[0].bytes = bytes[i % BATCH];
        item->templates[0].size = (size_t)size;
        if (i % BATCH == BATCH - 1) {
            assert_int_equal(iso_gallery_import(gallery, items, BATCH, false, NULL, &added, NULL),
                             0);
            assert_int_equal(added, BATCH);
        }
    }
    iso_gallery_close(gallery);
}

/* Copies a part of the first person's record. Returns the position of this part in the file. */
static size_t find_record(const char *directory, uint8_t part[PART])
{
    sqlite3 *db = NULL;
    sqlite3_stmt *row = NULL;
    size_t size = 0;
    assert_int_equal(sqlite3_open(scratch_path(directory, "g.db"), &db), SQLITE_OK);
    assert_int_equal(
        sqlite3_prepare_v2(db, "SELECT record FROM template ORDER BY id LIMIT 1", -1, &row, NULL),
        SQLITE_OK);
    assert_int_equal(sqlite3_step(row), SQLITE_ROW);
    const int length = sqlite3_column_bytes(row, 0);
    const uint8_t *record = sqlite3_column_blob(row, 0);
    assert_true(length > 2 * PART);
    memcpy(part, &record[length - 2 * PART], PART);
    assert_int_equal(sqlite3_finalize(row), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    uint8_t *file = scratch_read(scratch_path(directory, "g.db"), &size);
    const uint8_t *at = memmem(file, size, part, PART);
    assert_non_null(at);
    const size_t offset = (size_t)(at - file);
    free(file);
    return offset;
}

static void write_at(const char *directory, size_t offset, const void *bytes, size_t size)
{
    const int file = open(scratch_path(directory, "g.db"), O_WRONLY | O_CLOEXEC);
    assert_true(file >= 0);
    assert_int_equal(pwrite(file, bytes, size, (off_t)offset), size);
    assert_int_equal(close(file), 0);
}

static void a_record_that_changes_meanwhile_is_not_returned(void **state)
{
    static struct iso_template found[2], untouched[2];
    struct iso_fault fault = {.text = ""};
    uint8_t part[PART], flipped;
    int n = 77;
    add_whole_faces(*state);
    const size_t offset = find_record(*state, part);
    struct iso_gallery *gallery = gallery_rig_open(*state);
    const int64_t first = iso_gallery_find(gallery, "person 0")->id;
    const int64_t last = iso_gallery_find(gallery, "person 899")->id;
    flipped = part[0] ^ 0x10;
    write_at(*state, offset, &flipped, 1);
    assert_int_equal(iso_gallery_templates(gallery, first, found, 2, &n, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "damaged"));
    assert_int_equal(n, 77);
    assert_memory_equal(found, untouched, sizeof found);
    assert_int_equal(iso_gallery_templates(gallery, last, found, 2, &n, NULL),
                     0); /* others can be read */
    assert_int_equal(n, 1);
    iso_gallery_close(gallery);
    expect_refusal(*state, -EBADMSG, "damaged");
    write_at(*state, offset, part, 1);
    gallery = gallery_rig_open(*state);
    assert_int_equal(iso_gallery_templates(gallery, first, found, 2, &n, NULL), 0);
    assert_int_equal(n, 1);
    iso_gallery_close(gallery);
}

/* Removes the records of a person from the file, although it is locked. */
static void take_out(const char *directory, int64_t person)
{
    static const int flags = SQLITE_OPEN_READWRITE;
    sqlite3 *db = NULL;
    char sql[80];
    assert_int_equal(sqlite3_open_v2(scratch_path(directory, "g.db"), &db, flags, "unix-none"),
                     SQLITE_OK);
    (void)snprintf(sql, sizeof sql, "DELETE FROM template WHERE person_id = %lld",
                   (long long)person);
    assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_changes(db), 1);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

static void a_record_that_is_removed_meanwhile_is_noticed(void **state)
{
    static struct iso_template found[2], untouched[2];
    struct iso_fault fault = {.text = ""};
    int n = 77;
    add_whole_faces(*state);
    struct iso_gallery *gallery = gallery_rig_open(*state);
    const int64_t first = iso_gallery_find(gallery, "person 0")->id;
    const int64_t last = iso_gallery_find(gallery, "person 899")->id;
    take_out(*state, first);
    /* This is not a person without templates: a search would then continue as if nothing were
     * wrong. */
    assert_int_equal(iso_gallery_templates(gallery, first, found, 2, &n, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "records are missing"));
    assert_int_equal(n, 77);
    assert_memory_equal(found, untouched, sizeof found);
    assert_int_equal(iso_gallery_templates(gallery, last, found, 2, &n, NULL),
                     0); /* others can be read */
    assert_int_equal(n, 1);
    iso_gallery_close(gallery);
    expect_refusal(*state, -EBADMSG, "missing");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(an_empty_file_is_a_lost_gallery),
        TEST(a_record_that_changes_meanwhile_is_not_returned),
        TEST(a_record_that_is_removed_meanwhile_is_noticed),
        TEST(text_is_no_gallery),
        TEST(a_directory_is_no_gallery),
        TEST(a_database_of_others_is_no_gallery),
        TEST(a_newer_gallery_is_left_alone),
        TEST(needs_its_directory),
        TEST(a_file_that_is_cut_short_anywhere_is_refused),
        TEST(a_changed_file_never_yields_another_template),
        TEST(a_damaged_template_is_refused),
        TEST(a_template_without_a_person_is_refused),
        TEST(one_process_has_it),
    };
    gallery_rig_capacity = CAPACITY;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
